"""Lyapunov exponents: the growth of orthogonal perturbations of motions."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solvers.equations.module import (
    GeneratedModule,
    function,
    has_constraints,
    independent_perturbations,
    position_constraints,
)
from solvers.equations.number_checks import Values, positive, real_number
from solvers.equations.signature_checks import checked
from solvers.integration.compiled.kernel import Batch
from solvers.integration.compiled.memory_layout import STATUSES
from solvers.integration.loops import compiled_loop, python_loop
from solvers.integration.prepare import NotFinishedError
from solvers.integration.problem import validation
from solvers.integration.problem.problem import SHORTEST, Options
from solvers.integration.problem.status import Status
from solvers.integration.results.recorder import Outcome
from solvers.integration.variations.transition_matrix import METHOD
from solvers.runge_kutta.stepper import Array

NEW, FINISHED = STATUSES.index(None), STATUSES.index(Status.FINISHED)


class Frames:
    """Motions, each with orthonormal perturbations of its state that follow it.

    Parameters
    ----------
    module : module
        A generated module.
    starts : ndarray of shape (motions, state)
        Ordinary states.
    params : sequence of float or ndarray of shape (motions,)
        All parameters in order.
    count : int
        Number of perturbations of each motion, at most `independent_perturbations`.
    begin : float, optional
        Time in s of the starts.
    rtol, atol : float
        Tolerances, also of the perturbations.

    Attributes
    ----------
    t, y : ndarray of shape (motions,) and (motions, state)
        Times in s and ordinary states reached after `growth`.
    frames : ndarray of shape (motions, count, state)
        The perturbations there.
    status : ndarray of shape (motions,)
        Indices in `STATUSES`; a motion that fails does not go on.

    Raises
    ------
    ValueError
        When `module` has no variational form.
    """

    def __init__(
        self,
        module: GeneratedModule,
        starts: Array,
        params: Sequence[Any],
        count: int,
        begin: float = 0.0,
        *,
        rtol: float,
        atol: float,
    ) -> None:
        options = Options(METHOD, "variational", rtol, atol)
        problem = validation.problem_at_rest(module, (begin, begin + 1.0), options)
        lanes = [np.repeat(p, count) if np.ndim(p) else p for p in params]
        self._problem, self._program = compiled_loop.select(problem.with_params(lanes), lanes=True)
        self._module, self._params, self._count = module, params, count
        self.t, self.y = np.full(len(starts), begin), starts
        self.status: NDArray[np.intp] = np.full(len(starts), FINISHED)
        # in general directions, since there may be special ones without growth
        rng, size = np.random.default_rng(0), starts.shape[1]
        frame = np.linalg.qr(rng.normal(size=(size, size)))[0]
        self.frames = np.tile(frame, (len(starts), 1, 1))[:, :count]
        if has_constraints(module):
            normal = self._of_states("constraints_jacobian")
            allowed = np.eye(size) - np.linalg.pinv(normal) @ normal
            tangent = np.linalg.qr(allowed @ np.swapaxes(self.frames, 1, 2))[0]
            self.frames = np.ascontiguousarray(np.swapaxes(tangent, 1, 2))
        rows = self._rows()
        self._batch = Batch(self._program, self._problem, rows) if self._program else None

    def _rows(self) -> Array:
        """States with one perturbation, in rows."""
        states = np.repeat(self.y, self._count, axis=0)
        return np.concatenate([states, self.frames.reshape(states.shape)], axis=1)

    def advance(self, t: Array) -> Array:
        """Move to the times `t`, shape (motions,); return the growth, shape (motions, count).

        It is the logarithm of the factor by which the first perturbation has grown, and of those by
        which the parts of the others that are orthogonal to the former have grown.
        """
        if self._batch is None:
            self._in_python(t)
        else:
            self._in_lanes(self._batch, t)
        q, r = np.linalg.qr(np.swapaxes(self.frames, 1, 2))
        self.frames = np.swapaxes(q, 1, 2)
        return np.asarray(np.log(np.abs(np.diagonal(r, axis1=1, axis2=2))))

    def _in_lanes(self, batch: Batch, t: Array) -> None:
        motions, count, size = batch.motions, self._count, self.y.shape[1]
        ends, z = np.repeat(t, count), motions["z"]
        z[:, -size:] = self.frames.reshape(-1, size)
        motions["status"][np.repeat(self.status == FINISHED, count)] = NEW
        motions["t_end"], motions["min_h"] = ends, SHORTEST * np.spacing(ends)
        batch.restart()
        batch.run()
        status = motions["status"].reshape(-1, count)
        self.status = status[np.arange(len(t)), np.argmax(status != FINISHED, axis=1)].astype(int)
        changes = np.ldexp(z[:, -size:], motions["scale"].astype(int))
        self.frames = changes.reshape(self.frames.shape)
        motions["scale"] = 0
        # lanes of one motion have errors of their own
        for part in (z[:, :-size], motions["turns"]):
            part[:] = np.repeat(part[::count], count, axis=0)

    def growth(self, duration: Array, intervals: int) -> Array:
        """The growth in each of `intervals` equal parts of `duration`, shape (motions,).

        Its shape is (intervals, motions, count), its sum is that in the metric of the mass matrix,
        in which volumes of systems without friction do not change; NaN for motions that fail.
        """
        begin, before = self.t, self._metric_growth()
        times = begin + np.linspace(0.0, 1.0, intervals + 1)[1:, np.newaxis] * duration
        with np.errstate(all="ignore"):  # of motions that fail
            parts = np.array([self.advance(t) for t in times])
        if self._batch is not None:
            rows = self._batch.motions[:: self._count]
            self.t, self.y = rows["t"].copy(), self._batch.ordinary(rows)[:, : self.y.shape[1]]
        parts[-1] += self._metric_growth() - before
        parts[:, self.status != FINISHED] = np.nan
        return parts

    def _in_python(self, t: Array) -> None:
        size, rows, reached = self.y.shape[1], self._rows(), self.t.copy()
        for k, row in enumerate(rows):
            motion = k // self._count
            if self.status[motion] != FINISHED:
                continue
            own = [np.broadcast_to(p, len(rows))[k] for p in self._problem.form.params]
            span = (float(self.t[motion]), float(t[motion]))
            part = replace(self._problem.with_params(own), span=span, start=row)
            outcome = Outcome.at_start(part)
            python_loop.run(part, outcome)
            self.status[motion] = STATUSES.index(outcome.status)
            rows[k] = outcome.end[1]
            reached[motion] = outcome.end[0]
        self.t, self.y = reached, rows[:: self._count, :size].copy()
        self.frames = rows[:, size:].reshape(self.frames.shape)

    def status_of(self, motion: int) -> Status:
        """The status of a motion."""
        status = STATUSES[self.status[motion]]
        assert status is not None
        return status.without_events

    def _metric_growth(self) -> Array:
        """The growth if the metric of the mass matrix replaced that of the state's components."""
        n = len(self._module.COORDINATES)
        metric = self._of_states("mass_matrix")
        halves = self.frames.reshape(len(self.y), self._count, 2, n)
        if has_constraints(self._module):
            halves = self._tangential(halves, metric)
        gram = np.einsum("mkhi,mij,mlhj->mkl", halves, metric, halves)
        failed = self.status != FINISHED
        gram[failed | ~np.isfinite(gram).all(axis=(1, 2))] = np.eye(self._count)
        diagonal = np.diagonal(np.linalg.cholesky(gram), axis1=1, axis2=2)
        return np.asarray(np.log(diagonal))

    def _tangential(self, halves: Array, metric: Array) -> Array:
        """Perturbations without the part of velocities that follows from those of coordinates.

        It is perpendicular to the velocities that the constraints allow, whose volumes count.
        """
        n, holonomic = halves.shape[-1], position_constraints(self._module)
        G = self._of_states("constraints_jacobian")[:, holonomic:, n:]
        m = G.shape[1]
        matrix = np.zeros((len(G), n + m, n + m))
        matrix[:, :n, :n], matrix[:, :n, n:], matrix[:, n:, :n] = metric, np.swapaxes(G, 1, 2), G
        side = np.zeros((len(G), n + m, self._count))
        side[:, :n] = metric @ np.swapaxes(halves[:, :, 1], 1, 2)
        solution = np.linalg.pinv(matrix) @ side
        return np.stack([halves[:, :, 0], np.swapaxes(solution[:, :n], 1, 2)], axis=2)

    def _of_states(self, name: str) -> Array:
        """A matrix for each motion, by a function of the module."""
        arguments = (self.t, self.y.T, [np.asarray(p, float) for p in self._params])
        with np.errstate(all="ignore"):
            values = np.asarray(function(self._module, f"{name}_many")(*arguments))
        return np.broadcast_to(values, (*values.shape[:2], len(self.y))).transpose(2, 0, 1)


#: Parts of a run whose means give the standard error.
PARTS = 20


@dataclass(frozen=True)
class LyapunovSpectrum:
    """Lyapunov exponents.

    Attributes
    ----------
    exponents : ndarray of shape (state - residuals,)
        In 1/s, from the largest to the smallest; of systems with constraints, one for each
        independent perturbation that keeps them.
    errors : ndarray of the same shape
        Their standard errors in 1/s, from the means over `PARTS` parts of the motion, each of which
        should be much longer than the motion's correlation.
    t, y : float and ndarray of shape (state,)
        Time in s and state at the end, from which the motion can go on.
    """

    exponents: Array
    errors: Array
    t: float
    y: Array


@checked
def lyapunov_spectrum(
    module: GeneratedModule,
    y0: Values,
    params: Values,
    duration: float,
    *,
    interval: float = 2.0,
    rtol: float = 1e-9,
    atol: float = 1e-9,
) -> LyapunovSpectrum:
    """All Lyapunov exponents along a motion.

    Perturbations follow the variational equations and are made orthogonal again after every
    interval (G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn, Meccanica 15 (1980) 9-30), in
    the metric of the mass matrix: so the exponents of a system without friction add up to 0.

    Parameters
    ----------
    module, y0, params, rtol, atol
        As in `integrate`; a transient motion, if any, is to precede `y0`.
    duration : float
        Length of the motion in s, at least `PARTS` intervals.
    interval : float, optional
        Time in s between orthogonalisations, in which the largest perturbation should not grow by
        more than a factor of 1e6 relative to the smallest.

    Returns
    -------
    LyapunovSpectrum
        Exponents and their errors.

    Raises
    ------
    ValueError
        When an argument is invalid, or `module` has no variational form.
    solvers.integration.prepare.NotFinishedError
        When the motion does not last that long.

    Examples
    --------
    >>> import generated.double_pendulum as dp
    >>> from solvers import lyapunov_spectrum
    >>> spectrum = lyapunov_spectrum(dp, {"theta1": 2.0, "theta2": 2.5}, {}, 1000.0)
    >>> bool(spectrum.exponents[0] > 0.9 and abs(spectrum.exponents.sum()) < 1e-6)
    True
    """
    positive("interval", interval)
    if not real_number("duration", duration, "s") >= PARTS * interval:
        raise ValueError(
            f"duration = {duration} s must be at least {PARTS} intervals of {interval} s: "
            "lengthen it, or shorten the interval"
        )
    constants = validation.parameters(module, params)
    start = validation.initial_state(module, y0, params=constants.tolist())
    count = independent_perturbations(module)
    frames = Frames(module, start[np.newaxis], constants.tolist(), count, rtol=rtol, atol=atol)
    growth = frames.growth(np.array([duration]), round(duration / interval))[:, 0]
    if frames.status[0] != FINISHED:
        raise NotFinishedError(frames.status_of(0), float(frames.t[0]), tuple(frames.y[0].tolist()))
    means = [part.mean(axis=0) for part in np.array_split(growth * (len(growth) / duration), PARTS)]
    # parts may differ by one interval, the mean counts all alike
    exponents = growth.sum(axis=0) / duration
    errors = np.std(means, axis=0, ddof=1) / np.sqrt(PARTS)
    order = np.argsort(-exponents)
    return LyapunovSpectrum(exponents[order], errors[order], float(frames.t[0]), frames.y[0])
