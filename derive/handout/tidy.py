"""Sums of terms that are short to read: roots and divisors are kept as they are."""

import sympy as sp

from derive.mechanics.reduction import collected


def tidied(expression: sp.Expr, *variables: sp.Symbol) -> sp.Expr:
    """`expression` with one term for each function of `variables`, roots and divisors unchanged.

    An expanded divisor, such as the square of l² - x², hides that it is one.
    """
    powers = {
        power: power.base
        for power in expression.atoms(sp.Pow)
        if power.base.is_Add and not (power.exp.is_Integer and power.exp > 0)
    }
    bases = sorted({*powers.values()}, key=sp.default_sort_key)
    names = {base: sp.Symbol(f"root {k}", positive=True) for k, base in enumerate(bases)}
    flat = expression.xreplace({power: names[base] ** power.exp for power, base in powers.items()})
    total = collected(flat, *variables, *names.values())
    return total.xreplace({name: base for base, name in names.items()})
