"""Tangents of a position in turned axes, in which fewer of them depend on angles.

A turn of all tangents by the same angle does not change their dot products. In axes that turn with
a vehicle, tangents of its points do not depend on its heading ψ: (a cos ψ - b sin ψ, a sin ψ +
b cos ψ) becomes (a, b), whatever a and b are, so that nothing is expanded.
"""

from collections.abc import Sequence
from itertools import permutations
from typing import TypeAlias

import sympy as sp

Vector: TypeAlias = tuple[sp.Expr, ...]
#: Products, with numbers as their factors.
Products: TypeAlias = dict[sp.Expr, sp.Expr]


def turned(tangents: Sequence[Vector]) -> list[Vector]:
    """The tangents after turns about coordinate axes, while these remove angles from them."""
    best: list[Vector] | None = [*tangents]
    while best is not None:
        tangents, best = best, _simpler(best)
    return [*tangents]


def _simpler(tangents: Sequence[Vector]) -> list[Vector] | None:
    """The tangents after the first turn that removes angles from more of them than it adds."""
    angles = [[_angles(x) for x in tangent] for tangent in tangents]
    total = sum(len(set[sp.Expr]().union(*own)) for own in angles)
    every = {angle for own in angles for one in own for angle in one}
    for angle in sorted(every, key=sp.default_sort_key):
        for j, k in permutations(range(len(tangents[0])), 2):
            depends = [angle in own[j] or angle in own[k] for own in angles]
            pairs = [*zip(tangents, depends, strict=True)]
            added = sum(not yes and (t[j] != 0 or t[k] != 0) for t, yes in pairs)
            if sum(depends) <= added:
                continue
            new = [_without(t, angle, j, k) if yes else _with(t, angle, j, k) for t, yes in pairs]
            result = [t for t in new if t is not None]
            if len(result) == len(new) and sum(len(_angles(*t)) for t in result) < total:
                return result
    return None


def _angles(*formulas: sp.Expr) -> set[sp.Expr]:
    return {wave.args[0] for x in formulas for wave in x.atoms(sp.sin, sp.cos)}


def _with(tangent: Vector, angle: sp.Expr, j: int, k: int) -> Vector:
    """Components along axes that are turned from axis j towards k."""
    cosine, sine, components = sp.cos(angle), sp.sin(angle), [*tangent]
    components[j] = tangent[j] * cosine + tangent[k] * sine
    components[k] = tangent[k] * cosine - tangent[j] * sine
    return tuple(components)


def _without(tangent: Vector, angle: sp.Expr, j: int, k: int) -> Vector | None:
    """The same where the angle cancels; None if it does not."""
    waves = (sp.cos(angle), sp.sin(angle))
    first, second = _factors(tangent[j], waves), _factors(tangent[k], waves)
    if first is None or second is None:
        return None
    (a, minus_b), (b, also_a) = first, second
    if a != also_a or b != {product: -number for product, number in minus_b.items()}:
        return None
    components = [*tangent]
    components[j], components[k] = (
        sp.Add(*(number * product for product, number in part.items())) for part in (a, b)
    )
    return tuple(components)


def _factors(formula: sp.Expr, waves: Vector) -> tuple[Products, Products] | None:
    """The factors of the cosine and of the sine of an angle, if each term has one of both."""
    parts: tuple[Products, Products] = ({}, {})
    for term in sp.Add.make_args(formula):
        number, product = term.as_coeff_Mul()
        factors = sp.Mul.make_args(product)
        if number == 0:
            continue
        moving = [factor for factor in factors if factor.has(*waves)]
        inner: tuple[Products, Products] | None = None
        if moving == [waves[0]]:
            inner = ({sp.S.One: sp.S.One}, {})
        elif moving == [waves[1]]:
            inner = ({}, {sp.S.One: sp.S.One})
        elif len(moving) == 1 and moving[0].is_Add:
            inner = _factors(moving[0], waves)
        if inner is None:
            return None
        others = sp.Mul(*(factor for factor in factors if factor != moving[0]))
        for part, own in zip(parts, inner, strict=True):
            for factor, count in own.items():
                product = others * factor
                part[product] = part.get(product, sp.S.Zero) + number * count
    cosine, sine = ({product: n for product, n in part.items() if n} for part in parts)
    return cosine, sine
