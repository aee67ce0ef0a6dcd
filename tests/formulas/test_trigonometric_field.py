"""Rational functions of sines and cosines are elements of a field."""

import sympy as sp

from derive.formulas.trigonometric_field import TrigonometricField

x = sp.Symbol("x", real=True)


def test_the_inverse_of_a_cosine_is_never_zero() -> None:
    field = TrigonometricField([sp.cos(x)], [x])
    assert field.is_never_zero(field.value(1 / sp.cos(x)))
    assert not field.is_never_zero(field.value(sp.cos(x)))
