"""A compiled loop that integrates one motion again and again."""

import ctypes
from collections.abc import Sequence

from benchmarks.motions import Array
from solvers.equations.forms import fastest_form
from solvers.equations.module import GeneratedModule
from solvers.integration.compiled.kernel import Batch
from solvers.integration.loops import compiled_loop
from solvers.integration.problem import validation
from solvers.integration.problem.problem import Options


class RepeatedLoop:
    """The loop that `integrate` calls, without its preparation and its checks of the start."""

    def __init__(
        self, module: GeneratedModule, start: Sequence[float], end: float, options: Options
    ) -> None:
        problem = validation.problem(module, (0.0, end), start, module.DEFAULTS, options)
        problem = problem.with_form(fastest_form(module))
        room = compiled_loop.EVENT_CAPACITY if options.events else 0
        self.batch = Batch(compiled_loop.loop(problem), problem, occurrences=room)
        motions = self.batch.motions
        self._there, self._size = motions.ctypes.data, motions.nbytes
        self._first = ctypes.create_string_buffer(motions.tobytes(), self._size)

    def __call__(self) -> None:
        """Integrate from the start."""
        ctypes.memmove(self._there, self._first, self._size)
        self.batch.restart()
        self.batch.run()

    def end(self) -> Array:
        """The last state, coordinates and velocities."""
        return self.batch.ordinary(self.batch.motions)[0]
