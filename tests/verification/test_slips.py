"""Which corrections are those of one slip of the pen."""

import pytest

from derive.verification.documents.rules.evidence.slips import is_slip
from derive.verification.judging.verdict import Correction


@pytest.mark.parametrize(("wrong", "correct"), [
    ("m*g*l", "-m*g*l"),  # a sign
    ("m*g*l", "m*g*l/2"), ("2/3*k", "3/2*k"),  # a number
    ("(m*l + k*l)*g", "2*l*(m + k)*g"),
    ("m*g*sin(x)", "m*g*l*sin(x)"), ("m*l*v", "m*v"),  # a factor
    ("m*l*v**2", "m*l**2*v**2"), ("m*r**2", "m"),  # a power
    ("k*x", "k*x_dot"), ("m_1*g", "m_2*g"), ("sin(a)", "cos(a)"),  # one for another
    ("cos(a - b)", "cos(a + b)"), ("k/(a + b)", "k/(a + b)**2"), ("(x - y)/r", "(x - y)/r**3"),
    ("", "m*g*sin(x)/l"), ("a + b", "a + b + 2*a*b*cos(c)"),  # a term is missing
    ("a + b**2", "a + b"), ("1 + cos(x)", "1 - cos(x)"),  # one of several terms
    ("1 + cos(x)", "(const_7 - d*cos(x))/d"),  # up to a constant
    ("transpose(v)*v", "1/2*transpose(v)*v"),
])  # fmt: skip
def test_one_change_of_a_term_is_a_slip(wrong: str, correct: str) -> None:
    assert is_slip([Correction(wrong, correct)])


@pytest.mark.parametrize(("wrong", "correct"), [
    ("m", "32*m/195"), ("7*a", "64*a"), ("", "323/32*g"),  # no number that one writes
    ("m*r**3", "m"),  # too many powers
    ("m*l", "g*k*l"), ("m*l", "1/(m*l)"),  # several factors
    ("m*(a + b)", "m*(c + d)"), ("k*x", "k*x + m*g + c"),  # several terms
    ("a + b + c", "a + d"),
    ("", "m*g + k*x"), ("m*x", "m*x*(a + b)"),
    ("m*z_dot**2", "0"), ("a + b", "a"),  # a term too many
    ("transpose(u)*v", "transpose(v)*u"),  # unknown
    ("k*r**b", "k*r"),  # a power that is no number
])  # fmt: skip
def test_several_changes_are_no_slip(wrong: str, correct: str) -> None:
    assert not is_slip([Correction(wrong, correct)])


def test_several_terms_are_changed_alike() -> None:
    first, second = Correction("a*b", "-a*b"), Correction("c", "-c")
    assert is_slip([first, second])
    assert not is_slip([first, Correction("c", "2*c")])
    assert not is_slip([])
