"""Perturbations of initial states that keep the constraints."""

import numpy as np

from solvers.equations.forms import Form
from solvers.equations.starts.assembly import Array, Assembly, Flags


def tangent_start(form: Form, t: float, rows: Array, given: Flags) -> Array:
    """States in rows whose perturbations are tangent to the constraints.

    Perturbations of `given` components remain as they are, as far as the others can follow by
    linear equations: by the smallest change, in the metric of the mass matrix. What still violates
    the linearised constraints is removed by a change of all components.

    Parameters
    ----------
    form : Form
        A form with perturbations of a system with constraints.
    t : float
        Time in s.
    rows : ndarray of shape (motions, 2 state)
        States that satisfy the constraints, each with a perturbation.
    given : ndarray of bool, shape (state,)
        Which perturbations are given.

    Returns
    -------
    ndarray of shape (motions, 2 state)
    """
    size, result = len(form.module.STATE), rows.copy()
    y, changes = result[:, :size], result[:, size:]
    params = np.column_stack([np.broadcast_to(p, len(rows)) for p in form.constants])
    assembly = Assembly(form.module, params.reshape(len(rows), -1), t)
    if not given.all():
        every = [*range(len(assembly.names))]
        first, last = slice(0, assembly.n), slice(assembly.n, size)
        moving = assembly.in_constraints
        for part, of, free in ((first, assembly.of_positions, True), (last, every, moving)):
            # the residual of a perturbation is that which the change of all components removes
            removing = form.tangent_change(t, result)[:, part] / assembly.scales
            residuals = -np.einsum("kij,kj->ki", assembly.jacobian(y)[:, of], removing)
            changes[:, part] += assembly.smallest_change(y, residuals, ~given[part] & free, of)
    changes += form.tangent_change(t, result)
    return result
