"""How a motion depends on its start: perturbations by the variational equations, their matrix."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from solvers.equations.assembly import tangent_start
from solvers.equations.module import GeneratedModule
from solvers.equations.number_checks import Values
from solvers.equations.signature_checks import checked
from solvers.integration.compiled.kernel import Batch
from solvers.integration.compiled.memory_layout import STATUSES
from solvers.integration.loops import compiled_loop, python_loop
from solvers.integration.prepare import NotFinishedError
from solvers.integration.problem import validation
from solvers.integration.problem.problem import Options, Problem
from solvers.integration.problem.status import Status
from solvers.integration.problem.validation import time_span
from solvers.integration.results.recorder import Outcome
from solvers.runge_kutta.stepper import Array

METHOD = "verner98"


class Tangents:
    """A motion with perturbations, advanced from time to time.

    Parameters
    ----------
    module, t_span, y0, params, rtol, atol, max_steps
        As in `integrate`; the tolerances apply to the perturbations, too.
    changes : array_like of shape (state, n)
        Perturbations of the initial state, in columns; the nearest ones that constraints permit, in
        the metric of the mass matrix, take their places.
    parameter_changes : array_like of shape (parameters, n), optional
        Perturbations of the parameters, which belong to those of the state.

    Attributes
    ----------
    t : float
        Time in s reached.
    y : ndarray of shape (state,)
        Coordinates and velocities there.
    changes : ndarray of shape (state, n)
        The perturbations there, which may be changed.

    Raises
    ------
    ValueError
        When an argument is invalid, or `module` has no variational form.
    """

    def __init__(
        self,
        module: GeneratedModule,
        t_span: ArrayLike,
        y0: Values,
        params: Values,
        changes: Array,
        *,
        rtol: float,
        atol: float,
        parameter_changes: Array | None = None,
        max_steps: int = Options.max_steps,
    ) -> None:
        constants = validation.parameters(module, params)
        if parameter_changes is None:
            form, perturbed = "variational", [*constants]
        else:
            form, perturbed = "sensitivity", [*parameter_changes, *constants]
            constants = np.concatenate([np.zeros(len(parameter_changes)), constants])
        options = Options(METHOD, form, rtol, atol, max_steps=max_steps)
        problem = validation.problem_at_rest(module, t_span, options, constants)
        problem = problem.with_params(perturbed)
        self._problem, self._program = compiled_loop.select(problem, lanes=True)
        self._batch: Batch | None = None
        self.t, self.changes = problem.span[0], changes
        self.y = validation.initial_state(module, y0, params=problem.form.constants, t=self.t)

    def advance(self, t: float) -> None:
        """Move to time `t` in s; `NotFinishedError` where the motion does not get there."""
        part = replace(self._problem, span=(self.t, t))
        starts = np.array([[*self.y, *change] for change in self.changes.T])
        if part.form.has_constraints:
            starts = tangent_start(part.form, self.t, starts, np.ones(len(self.y), bool))
        if self._program is None:
            ends = self._in_python(part, starts)
        else:
            if self._batch is None:
                self._batch = Batch(self._program, part, starts)
            else:
                self._batch.resume(part, starts)
            self._batch.restart()
            self._batch.run()
            ends = self._batch.ordinary(self._batch.motions)
            for motion, end in zip(self._batch.motions, ends, strict=True):
                self._check(STATUSES[motion["status"]], float(motion["t"]), end)
        n = len(self.y)
        self.t, self.y, self.changes = t, ends[0, :n].copy(), ends[:, n:].T.copy()

    def _in_python(self, part: Problem, starts: Array) -> Array:
        ends = []
        for k, start in enumerate(starts):
            own = [np.broadcast_to(p, len(starts))[k] for p in part.form.params]
            outcome = Outcome.at_start(problem := replace(part.with_params(own), start=start))
            python_loop.run(problem, outcome)
            self._check(outcome.status, *outcome.end)
            ends.append(outcome.end[1])
        return np.array(ends)

    def _check(self, status: Status | None, t: float, end: Array) -> None:
        assert status is not None
        if status is not Status.FINISHED:
            raise NotFinishedError(status.without_events, t, tuple(end[: len(self.y)].tolist()))


@dataclass(frozen=True)
class Transition:
    """The end of a motion, and its derivatives by the start.

    Attributes
    ----------
    y : ndarray of shape (state,)
        Coordinates and velocities at the end.
    matrix : ndarray of shape (state, state)
        ∂y/∂y0: column k is the change of y by a small change of component k of the start. Of
        systems with constraints, the nearest change that they permit, in the metric of the mass
        matrix, takes its place.
    """

    y: Array
    matrix: Array


@checked
def transition_matrix(
    module: GeneratedModule,
    t_span: ArrayLike,
    y0: Values,
    params: Values,
    *,
    rtol: float = 1e-12,
    atol: float = 1e-12,
) -> Transition:
    """The end of a motion and the state-transition matrix, by the variational equations.

    Parameters
    ----------
    module, t_span, y0, params, rtol, atol
        As in `integrate`; the tolerances apply to the matrix, too.

    Returns
    -------
    Transition
        The end and the matrix.

    Raises
    ------
    ValueError
        When an argument is invalid, or `module` has no variational form.
    solvers.integration.prepare.NotFinishedError
        When the motion does not reach its end.

    Examples
    --------
    >>> import numpy as np
    >>> import generated.single_pendulum as sp
    >>> from solvers import transition_matrix
    >>> matrix = transition_matrix(sp, (0, 10), {"theta": 1.0}, {}).matrix
    >>> bool(abs(np.linalg.det(matrix) - 1) < 1e-9)  # Liouville's theorem
    True
    """
    identity = np.eye(len(module.STATE))
    motion = Tangents(module, t_span, y0, params, identity, rtol=rtol, atol=atol)
    motion.advance(time_span(t_span)[1])
    return Transition(motion.y, motion.changes)
