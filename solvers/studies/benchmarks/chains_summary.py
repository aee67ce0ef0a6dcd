"""The figures of chains of pendulums as tables."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from solvers.equations.module import GeneratedModule
from solvers.studies.benchmarks import chains, growth
from solvers.studies.benchmarks.growth import Maker


def figures(
    made: Maker, rival: Callable[[int], float], module: Callable[[str], GeneratedModule], hy: Any
) -> dict[str, Any]:
    """All figures, in seconds, bytes and powers of the number of pendulums.

    Parameters
    ----------
    made, rival : callable
        Derive a chain here, and with SymPy's own mechanics.
    module : callable
        Gives the generated module of a system.
    hy : module
        heyoka.

    Returns
    -------
    dict of str
        As `told` takes them, by ``derived and emitted``, ``right-hand sides``, ``integrated``,
        ``growth`` and ``exponents``.
    """
    rows = growth.growth(made)
    return {
        "derived and emitted": chains.derivations(made, rival),
        "right-hand sides": chains.right_hand_sides(made, hy),
        "integrated": chains.integration(module(f"chain_{chains.LENGTH}"), hy),
        "growth": rows,
        "exponents": growth.exponents(rows),
    }


def told(found: Mapping[str, Any]) -> Iterator[str]:
    """The figures, a line each."""
    yield "Chains of n pendulums, derived and emitted; SymPy's LagrangesMethod and lambdify:"
    for row in found["derived and emitted"]:
        ours, theirs = row["holonomic"], row["sympy"]
        yield f"  n = {row['n']:>2}: {ours:6.2f} s, {theirs:6.1f} s: {theirs / ours:.0f} x"
    yield "Their right-hand sides, compiled; one state beside a textbook's C, many beside heyoka:"
    for row in found["right-hand sides"]:
        one, many = row["textbook"] / row["one"], row["heyoka"] / row["lanes"]
        yield (
            f"  n = {row['n']:>2}: {row['one'] * 1e9:5.0f} ns, {one:.2f} x; "
            f"{row['lanes'] * 1e9:6.1f} ns, {many:.1f} x"
        )
    both = found["integrated"]
    yield (
        f"A chain of {chains.LENGTH} over {chains.END:g} s, to {chains.ERROR:g}: "
        f"{both['holonomic'] * 1e3:.2f} ms; heyoka takes "
        f"{both['heyoka'] / both['holonomic']:.1f} times as long"
    )
    yield "Growth with n, in s, and the power of n in the larger half:"
    yield "       n" + "".join(f"{name:>13}" for name in growth.CURVES.values()) + "        C text"
    for row in found["growth"]:
        costs = "".join(f"{row[key]:13.2g}" for key in growth.CURVES)
        yield f"  {row['n']:>6}{costs}{row['bytes'] / 1e3:11.0f} kB"
    powers = found["exponents"]
    yield "   power" + "".join(f"{powers[key]:13.1f}" for key in (*growth.CURVES, "bytes"))
