"""The memory of results, estimated before anything runs."""

import os
from math import ceil

import numpy as np

from solvers.integration.problem.problem import Problem

#: Share of the machine's memory that results may take, and their copies while they are collected.
SHARE, COPIES = 0.5, 3
#: Bytes of a number.
NUMBER = 8


def available_bytes() -> float:
    """Bytes that the results of one call may take."""
    return SHARE * os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")


def check_memory(what: str, rows: int, components: int, remedy: str) -> None:
    """Refuse results of so many states, each with its time, that do not fit into memory."""
    size = COPIES * NUMBER * rows * (1 + components)
    if size > available_bytes():
        raise ValueError(
            f"{what} would take {size / 1e9:.3g} GB of memory, more than the "
            f"{available_bytes() / 1e9:.3g} GB that results may take here: {remedy}"
        )


def check_times(t_eval: object, components: int) -> None:
    """Refuse more times than states fit into memory."""
    match t_eval:
        case np.ndarray():
            count = t_eval.size
        case list() | tuple():
            count = len(t_eval)
        case _:
            count = 0  # refused later
    check_memory(f"the states at {count} times t_eval", count, components, "give fewer times")


def limit_steps(problem: Problem) -> int:
    """The number of steps after which a run must stop, so that their ends fit into memory.

    Where steps are fixed, a run that would not reach its end is refused.
    """
    if problem.samples is not None:
        return problem.max_steps
    components = len(problem.start)
    if problem.h is not None:
        begin, end = problem.span
        steps = min(ceil(abs(end - begin) / problem.h), problem.max_steps)
        remedy = "give the times t_eval at which states are to be recorded, such as [t_end]"
        check_memory(f"the states at the ends of {steps} steps", steps, components, remedy)
    fitting = available_bytes() / (COPIES * NUMBER * (1 + components))
    return min(problem.max_steps, int(fitting))
