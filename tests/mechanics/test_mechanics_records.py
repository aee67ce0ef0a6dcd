"""What follows from the derivations of systems of many kinds, as formulas and as messages."""

import warnings

import constrained_systems as constrained
import velocity_constraints as mechanisms
from cart_pole import cart_pole
from recording import Record

from derive import Derivation, load
from derive.mechanics.constraints.differentiated_constraints import Constraints
from derive.system.parts import SystemDefinitionError

SHIPPED = (
    "double_pendulum", "elastic_pendulum", "rotating_hoop", "spherical_pendulum", "heavy_top",
    "chaplygin_sleigh", "swinging_atwood", "duffing",
)  # fmt: skip


def test_consequences_of_derivations_are_as_recorded(record: Record) -> None:
    systems = [*map(load, SHIPPED), constrained.sleigh(), constrained.lifted(), cart_pole,
        mechanisms.yoke()]  # fmt: skip
    lines = []
    for system in systems:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            derivation = Derivation(system)
        results = {
            "identifiable": derivation.identifiable,
            "regressor": lambda d=derivation: [*d.regressor.parameters],
            "equilibria": derivation.equilibria,
            "stiffness": lambda d=derivation: d.linearisation().stiffness_matrix.tolist(),
            "state space": lambda d=derivation: d.state_space().A.tolist(),
            "constraints": lambda s=system: Constraints(s).integrability,
        }
        for name, result in results.items():
            try:
                text = str(result())
            except SystemDefinitionError as error:
                text = f"refused: {error}"
            lines.append(f"{system.name} {name}: {text}".replace("\n", "; "))
    record.check("\n".join(lines))
