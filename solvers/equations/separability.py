"""Systems whose kinetic energy depends on velocities alone, and potential energy on positions.

Their accelerations are those of positions: kicks of velocities and drifts of positions, in turn,
are motions of parts of the system. Generated modules state the variables of their functions.
"""

from solvers.equations.module import (
    GeneratedModule,
    has_constraints,
    has_function,
    part,
    switching_functions,
)
from solvers.io.suggestion import listed


def coupling(module: GeneratedModule) -> str:
    """The reason why accelerations do not depend on positions and time alone; empty if they do."""
    if has_constraints(module):
        return f"the system {module.SYSTEM} has constraints, whose forces depend on velocities"
    if switching_functions(module):
        return f"forces of the system {module.SYSTEM} have kinks or jumps, at which steps end"
    positions = module.COORDINATES
    names = part(module, "rhs").VARIABLES["accelerations"]
    velocities = [name for name in names if name not in positions]
    if not velocities:
        return ""
    of_masses: tuple[str, ...] = ()
    if has_function(module, "mass_matrix"):
        of_masses = part(module, "mass_matrix").VARIABLES["mass_matrix"]
    if of_masses:
        return f"the mass matrix of the system {module.SYSTEM} depends on {listed(of_masses)}"
    return f"accelerations of the system {module.SYSTEM} depend on {listed(velocities)}"
