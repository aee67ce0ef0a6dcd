"""Specifications of the functions of generated modules: state, result, docstring, existence."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from derive.codegen.forms.factorisation import LARGE
from derive.mechanics.derivation import Derivation
from derive.system.symbols import TIME

#: Functions of generalized forces, which controllers and identification need.
FORCES = ("inverse_dynamics", "coriolis", "gravity", "regressor", "base_parameters")
#: Functions that exports need, in no file of a system.
OF_EXPORTS = ("energy_rational",)

Form = Literal["lagrangian", "hamiltonian", "rational", "variational", "sensitivity", "parameters"]


def _energy(derivation: Derivation) -> str:
    if TIME in derivation.variables:
        return "Jacobi's integral qdot dL/dqdot - L, not T + V, since positions depend on time"
    return "Total energy T + V"


def _equilibrium(derivation: Derivation) -> str:
    return f"q = ({', '.join(map(str, derivation.equilibrium or ()))})"


def _reactions(derivation: Derivation) -> str:
    return ", ".join(symbol.name for symbol in derivation.system.reactions)


def _outputs(derivation: Derivation) -> str:
    return ", ".join(name for name, _ in derivation.system.measured)


def _switches(derivation: Derivation) -> str:
    return ", ".join(map(str, derivation.switching_functions))


def _multipliers(derivation: Derivation) -> str:
    return ", ".join(one.name for one in derivation.system.all_conditions)


def _integrals(derivation: Derivation) -> str:
    return ", ".join(map(str, derivation.integrals))


def _redundant(derivation: Derivation) -> str:
    return ", ".join(one.name for one in derivation.redundant)


def _reacting(derivation: Derivation) -> str:
    return "" if _is_free(derivation) else " and constraints"


def _base(derivation: Derivation) -> str:
    return ", ".join(map(str, derivation.regressor.parameters))


def _has_base(derivation: Derivation) -> bool:
    return _is_free(derivation) and bool(derivation.system.parameters) and is_small(derivation)


def _is_free(derivation: Derivation) -> bool:
    return not derivation.system.conditions


def is_small(derivation: Derivation) -> bool:
    """Whether n² entries of n terms each are not too much text."""
    return len(derivation.system.q) < LARGE


@dataclass(frozen=True)
class FunctionSpec:
    """A function that a generated module may have; a property of a form gives its outputs."""

    name: str  # also that of the property
    form: Form  # of the state that it takes; of none if it takes parameters alone
    shape: str  # names of the lengths of the result's axes; empty for a number
    summary: str  # of its docstring; {} stands for the detail
    returns: str
    detail: Callable[[Derivation], str] = lambda derivation: ""
    exists: Callable[[Derivation], bool] = lambda derivation: True  # if there is such a state
    takes_accelerations: bool = False


SPECS = (
    FunctionSpec("rhs", "lagrangian", "state",
        "Right-hand side of y' = rhs(t, y, params) for y = (q, qdot).",
        "Time derivative of y: velocities, then accelerations from M qddot = f."),
    FunctionSpec("jacobian", "lagrangian", "state state",
        "Jacobian of `rhs`.",
        "Entry [i][j] is the derivative of rhs[i] with respect to y[j]."),
    FunctionSpec("input_jacobian", "lagrangian", "state inputs",
        "Derivatives of `rhs` with respect to the inputs.",
        "Entry [i][j] is the derivative of rhs[i] with respect to input j."),
    FunctionSpec("parameter_jacobian", "lagrangian", "state parameters",
        "Derivatives of `rhs` with respect to the parameters, without inputs.",
        "Entry [i][j] is the derivative of rhs[i] with respect to parameter j.",
        exists=is_small),
    FunctionSpec("outputs", "lagrangian", "outputs",
        "Outputs {}.",
        "One number for each.", _outputs),
    FunctionSpec("outputs_jacobian", "lagrangian", "outputs state",
        "Derivatives of `outputs` with respect to the state.",
        "Entry [i][j] is the derivative of output i with respect to y[j]."),
    FunctionSpec("outputs_parameter_jacobian", "lagrangian", "outputs params",
        "Derivatives of `outputs` with respect to the parameters, with inputs.",
        "Entry [i][j] is the derivative of output i with respect to params[j]."),
    FunctionSpec("switches", "lagrangian", "2 switches",
        "Switching functions {}, at whose zeros forces have kinks or jumps.",
        "The functions, then their rates of change along the motion.",
        _switches),
    FunctionSpec("switches_rational", "rational", "2 switches",
        "`switches` of the rational state.",
        "The functions, then their rates of change along the motion."),
    FunctionSpec("switches_variational", "variational", "4 switches",
        "`switches` of the variational state, and their linear perturbations.",
        "The functions, their rates of change along the motion, and the perturbations of both."),
    FunctionSpec("switches_sensitivity", "sensitivity", "4 switches",
        "`switches_variational` with perturbed parameters, whose perturbations precede them.",
        "The functions, their rates of change along the motion, and the perturbations of both.",
        exists=lambda derivation: bool(derivation.system.params) and is_small(derivation)),
    FunctionSpec("energy", "lagrangian", "",
        "{}.",
        "Energy in J.", _energy),
    FunctionSpec("power", "lagrangian", "",
        "Rate of change of `energy`: power of applied forces, friction and prescribed motion.",
        "Power in W.",
        exists=lambda derivation: derivation.power != 0 or any(derivation.constraint_drift)),
    FunctionSpec("constraints", "lagrangian", "residuals",
        "Residuals of the constraints, which are 0 along a motion.",
        "Constraints of the coordinates, then rates of these and constraints of velocities."),
    FunctionSpec("constraints_jacobian", "lagrangian", "residuals state",
        "Derivatives of `constraints` with respect to the state.",
        "Entry [i][j] is the derivative of residual i with respect to y[j]."),
    FunctionSpec("integrals", "lagrangian", "integrals",
        "Functions {} of the coordinates, which constraints of velocities keep constant.",
        "One number for each.", _integrals),
    FunctionSpec("integrals_rational", "rational", "integrals",
        "`integrals` of the rational state.",
        "One number for each."),
    FunctionSpec("redundant_constraints", "lagrangian", "redundant",
        "Residuals of the constraints {}, which follow from the others, with default parameters.",
        "One for each; where it is not 0, the parameters are such that none follows.", _redundant),
    FunctionSpec("multipliers", "lagrangian", "multipliers",
        "Multipliers {} of the constraints: their reactions.",
        "One for each constraint.", _multipliers),
    FunctionSpec("correction", "lagrangian", "state",
        "Changes of y that remove small residuals of the constraints, by one step of Newton's "
        "method.",
        "Changes of coordinates and of velocities, the smallest by the mass matrix.",
        exists=lambda derivation: not _is_free(derivation)),
    FunctionSpec("correction_rational", "rational", "state",
        "`correction` of the rational state.",
        "Changes of coordinates, angles among them, and of velocities.",
        exists=lambda derivation: not _is_free(derivation)),
    FunctionSpec("correction_variational", "variational", "4 q",
        "`correction` of the motion, and changes that make its perturbation tangent.",
        "Changes of coordinates, of velocities, and of the perturbations of both.",
        exists=lambda derivation: not _is_free(derivation)),
    FunctionSpec("correction_sensitivity", "sensitivity", "4 q",
        "`correction_variational` with perturbed parameters, whose perturbations precede them.",
        "Changes of coordinates, of velocities, and of the perturbations of both.",
        exists=lambda derivation: not _is_free(derivation)
        and bool(derivation.system.params) and is_small(derivation)),
    FunctionSpec("energy_rational", "rational", "",
        "`energy` of the rational state.",
        "Energy in J."),
    FunctionSpec("reactions", "lagrangian", "reactions",
        "Forces that hold {} constant, by Lagrange's multipliers.",
        "One for each: a rod's tension, positive where it pulls.",
        _reactions),
    FunctionSpec("mass_matrix", "lagrangian", "q q",
        "Mass matrix M(q): the kinetic energy is qdot M qdot / 2.",
        "M, symmetric and positive definite, row by row."),
    FunctionSpec("inverse_dynamics", "lagrangian", "q",
        "Generalized forces that produce the accelerations qddot: M qddot - f, where inputs are 0.",
        "One for each coordinate: what inputs{} have to produce.", _reacting,
        takes_accelerations=True),
    FunctionSpec("coriolis", "lagrangian", "q",
        "Coriolis and centrifugal terms C(q, qdot) qdot of M qddot + C qdot + dV/dq = forces.",
        "One for each coordinate."),
    FunctionSpec("gravity", "lagrangian", "q",
        "Terms dV/dq of gravity and springs of M qddot + C qdot + dV/dq = forces.",
        "One for each coordinate."),
    FunctionSpec("regressor", "lagrangian", "q base",
        "Y of `inverse_dynamics` = Y π, with π the `base_parameters`.",
        "Entry [i][j] is the factor of base parameter j in force i.",
        exists=_has_base, takes_accelerations=True),
    FunctionSpec("base_parameters", "parameters", "base",
        "Combinations π of parameters in which `inverse_dynamics` is linear.",
        "{}.", _base, _has_base),
    FunctionSpec("positions", "lagrangian", "masses axes",
        "Positions of the masses.",
        "One row a mass: its Cartesian components in m, the last one upwards."),
    FunctionSpec("points", "lagrangian", "points axes",
        "Points of `LINKS`, which pictures join.",
        "One row a point: its Cartesian components in m, the last one upwards."),
    FunctionSpec("angular_momentum", "lagrangian", "axes",
        "Angular momentum about the origin.",
        "Its Cartesian components in kg m^2/s.",
        exists=lambda derivation: bool(derivation.bodies)),
    FunctionSpec("hamiltonian_state", "lagrangian", "state",
        "State (q, p) of the Hamiltonian form at y = (q, qdot).",
        "Coordinates, then momenta p = M qdot.", exists=_is_free),
    FunctionSpec("rhs_hamiltonian", "hamiltonian", "state",
        "Right-hand side of y' = rhs_hamiltonian(t, y, params) for y = (q, p).",
        "Time derivative of y: velocities from M qdot = p, then -dH/dq."),
    FunctionSpec("jacobian_hamiltonian", "hamiltonian", "state state",
        "Jacobian of `rhs_hamiltonian`.",
        "Entry [i][j] is the derivative of rhs_hamiltonian[i] with respect to y[j].",
        exists=is_small),
    FunctionSpec("energy_hamiltonian", "hamiltonian", "",
        "Hamiltonian H(q, p): `energy` by momenta.",
        "Energy in J."),
    FunctionSpec("lagrangian_state", "hamiltonian", "state",
        "State (q, qdot) of the Lagrangian form at y = (q, p).",
        "Coordinates, then velocities from M qdot = p."),
    FunctionSpec("rational_state", "lagrangian", "rational",
        "State of the rational form at y = (q, qdot).",
        "Sine and cosine of every angle, other coordinates, velocities."),
    FunctionSpec("rhs_rational", "rational", "rational",
        "Right-hand side of y' = rhs_rational(t, y, params), without sines and cosines of angles.",
        "Time derivative of y."),
    FunctionSpec("rhs_variational", "variational", "variational",
        "Right-hand side of y' = rhs_variational(t, y, params): a motion and its linear "
        "perturbation.",
        "Time derivative of y: of the motion, then of the perturbation."),
    FunctionSpec("rhs_sensitivity", "sensitivity", "sensitivity",
        "`rhs_variational` with perturbed parameters, whose perturbations precede them.",
        "Time derivative of y: of the motion, then of the perturbation.",
        exists=lambda derivation: bool(derivation.system.params) and is_small(derivation)),
    FunctionSpec("equilibrium", "parameters", "q",
        "Coordinates at the equilibrium.",
        "{}.", _equilibrium, lambda derivation: derivation.equilibrium is not None),
    FunctionSpec("linear", "parameters", "2 q q",
        "Matrices of small displacements x from the equilibrium {}.",
        "M0 and K of M0 xddot + K x = 0.", _equilibrium,
        lambda derivation: derivation.equilibrium is not None and derivation.is_linearisable),
)  # fmt: skip
