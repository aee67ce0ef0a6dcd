"""Projection onto the constraints: of states, and of their perturbations onto the tangent space."""

import numpy as np

from solvers.equations.forms import Array, Form
from solvers.equations.module import function, integrals

#: Steps of Newton's method onto constraints: the first corrects the positions to the square of
#: their residuals, the second the velocities there.
CORRECTIONS = 2


def projected(form: Form, t: float, z: Array) -> Array:
    """The state `z` of a form with sin² + cos² = 1 restored, moved onto the constraints."""
    z = _normalised(form, z)
    for _ in range(CORRECTIONS * form.has_constraints):
        correction = function(form.module, form.correction)
        change = form.value(correction, t, z, (*form.params, *form.integrals)).ravel()
        for k, i in form.angle_columns:
            z[i : i + 2] += change[k] * np.array([z[i + 1], -z[i]])
        for k, i in form.shared_columns:
            z[i] += change[k]
        z = _normalised(form, z)
    return z


def _normalised(form: Form, z: Array) -> Array:
    z = z.copy()
    for _, i in form.angle_columns:
        z[i : i + 2] /= np.hypot(z[i], z[i + 1])
    return z


def tangent_change(form: Form, t: float, rows: Array) -> Array:
    """Changes that make the perturbations of ordinary states, in rows, tangent."""
    params = [*form.params]
    if integrals(form.module):
        states = rows[:, : len(form.module.STATE)]
        params += [*form.many("integrals_many", t, states, form.constants).T]
    changes = form.many(f"{form.correction}_many", t, form.rearranged(rows), params)
    return np.hstack([changes[:, :, 2], changes[:, :, 3]])
