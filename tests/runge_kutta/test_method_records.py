"""All numbers that follow from the coefficients of each method."""

import numpy as np
from recording import Record

from solvers.runge_kutta.continuous_extension import ContinuousExtension
from solvers.runge_kutta.method_catalogue import load, names
from solvers.runge_kutta.stability_function import StabilityFunction

#: Properties of a tableau, in its own words.
PROPERTIES = (
    "stages order embedded_order error_order is_fsal is_explicit is_collocation is_radau "
    "is_parallel is_splitting takes_any_form needs_jacobian estimates_error"
).split()


def test_methods_are_as_recorded(record: Record) -> None:
    lines = []
    for name in names():
        tableau = load(name)
        pairs = ((key, getattr(tableau, key)) for key in PROPERTIES)
        known = (f"{key}={value:d}" for key, value in pairs if value)
        function = StabilityFunction.of(tableau)
        intervals = function.real_stability_interval, function.imaginary_stability_interval
        at = np.abs(function(np.array([-1.0, 1j, -2 + 1j])))
        numbers = " ".join(f"{x:.7g}" for x in (*intervals, *at))
        lines.append(f"{name}: {tableau.title}; {' '.join(known)}; {numbers}")
        if not tableau.is_collocation:
            extension = ContinuousExtension.of(tableau)
            shapes = extension.natural_order, extension.rounds, extension.extended.shape
            size = np.linalg.norm(extension.extended), np.linalg.norm(extension.integrals)
            least = extension.least_samples
            lines.append(
                f"    extension {shapes} {size[0]:.6f} {size[1]:.6f}, from {least} samples"
            )
    record.check("\n".join(lines))
