"""Frequencies of small motions, amplitudes, equations of both, and motions in time."""

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cached_property
from itertools import chain, combinations, takewhile

import sympy as sp

from derive.formulas.expression import parse
from derive.formulas.generic_values import is_nonzero, is_small
from derive.formulas.syntax import ExpressionError
from derive.system.symbols import TIME
from derive.verification.documents.formula_translation import FormulaText, order, stem
from derive.verification.documents.rules.consequences import WithVerdict, opposed
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.roles import Roles
from derive.verification.documents.rules.side_verdict import CORRECT, SideVerdict, plain
from derive.verification.documents.rules.small_motions import (
    MAX_INVERSE,
    SmallMotions,
    along,
    has_initial_values,
)
from derive.verification.documents.statements import (
    SQUARE,
    WORD,
    DocumentFormula,
    is_motion_of_several,
)
from derive.verification.judging.reference_system import depends_on

#: Letters of angular frequencies, frequencies and periods: a factor and a power of the first.
FREQUENCY_LETTERS: dict[str, tuple[sp.Expr, int]] = {
    **dict.fromkeys(("omega", "Omega", "w"), (sp.S.One, 1)),
    **dict.fromkeys(("f", "nu"), (1 / (2 * sp.pi), 1)),
    **dict.fromkeys(("T", "P", "tau"), (2 * sp.pi, -1)),
}
#: Words of sentences about them.
ABOUT_FREQUENCIES = re.compile(
    "fre[qc]uen|fréquen|frequenz|pulsa|p[eé]riod|oscill|schwing|eigen|harmoni|natural|\\bSHM\\b|周期|频率"
    "|頻率|振動数",
    re.IGNORECASE,
)
OF_SMALL_MOTIONS = "it is that of small motions"
#: Letters of which the determinant of the equations of small motions is a function.
ROOTS = ("omega", "Omega", "w", "lambda", "lamda", "s")
OF_DETERMINANT = "it determines the frequencies of small motions"


class Frequencies:
    """Verdicts on frequencies by the linearised equations of motion about an equilibrium."""

    def __init__(self, namespace: DocumentNamespace, linear: SmallMotions, roles: Roles) -> None:
        self._namespace, self._linear, self._roles = namespace, linear, roles

    def verdict(
        self, formula: DocumentFormula, name: str, side: FormulaText, power: int
    ) -> SideVerdict | None:
        """The verdict on a power of a frequency or period; None if it can be another quantity."""
        system = self._namespace.derivation.system
        letter, _, index = name.partition("_")
        value = self._namespace.value(side.text)
        is_named = letter in FREQUENCY_LETTERS and not isinstance(value, sp.MatrixBase)
        has_place = 0 < len(system.q) <= MAX_INVERSE and not system.constraints
        if not is_named or not has_place or self._linear.place is None:
            return None
        if value == 0 or not value.free_symbols <= {*system.params}:
            return None
        M, D, K, _ = self._linear.matrices
        factor, sign = FREQUENCY_LETTERS[letter]
        square = (value ** sp.Rational(1, power) / factor) ** (2 * sign)
        is_zero = self._namespace.model.context.is_zero
        if is_zero((K - square * M).det()):
            return plain("verified", formula, OF_SMALL_MOTIONS)
        if len(system.q) > 1:
            return None
        required = K[0] / M[0]
        if is_zero(square - required + (D[0] / M[0]) ** 2 / 4):
            return plain("verified", formula, f"{OF_SMALL_MOTIONS} with friction")
        is_about = index in ("", "0", "n") and ABOUT_FREQUENCIES.search(formula.occurrence.prose)
        if not is_about or not self._is_only_one(required) or any(D):
            return None
        if sp.cancel(square).free_symbols != sp.cancel(required).free_symbols:
            return None  # that of another motion
        correct = factor * sp.sqrt(required) ** sign
        result = self._roles.value(side, name, correct**power)
        return result if result.verdict.verdict == "wrong" else None

    def of_mode(self, formula: DocumentFormula) -> SideVerdict | None:
        """The verdict on a frequency of small motions, also of a name that is defined by others."""
        square = SQUARE.fullmatch(formula.sides[0].text)
        name, power = (square[1], 2) if square else (formula.subject, 1)
        with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
            result = self.verdict(formula, name, formula.sides[-1], power)
            return result if result and result.verdict.verdict in CORRECT else None
        return None

    def contradicted(self, verdicts: Sequence[WithVerdict]) -> list[WithVerdict]:
        """The verdicts, with `wrong` for a frequency to which another formula gives its value.

        One term of it must be another one.
        """
        result, right = [*verdicts], dict[str, tuple[DocumentFormula, int]]()
        for formula, one in verdicts:
            if one.verdict.verdict == "verified" and OF_SMALL_MOTIONS in one.verdict.note:
                right.setdefault(*_named(formula))
        for number, (formula, one) in enumerate(verdicts):
            name, (_, power) = _named(formula)
            if one.verdict.verdict == "definition" and name and name in right:
                other, exponent = right[name]
                with suppress(ExpressionError, NotImplementedError):
                    value = self._namespace.value(other.sides[-1].text)
                    correct = value ** sp.Rational(power, exponent)
                    own = self._roles.value(formula.sides[-1], name, correct)
                    if own.verdict.verdict == "wrong" and len(own.verdict.corrections) == 1:
                        result[number] = formula, own
        return result

    def determining(self, formula: DocumentFormula, unknown: Sequence[str]) -> SideVerdict | None:
        """The verdict on an equation for frequencies, such as (2*k - m*omega**2)**2 - k**2 = 0.

        Each side is a factor of the determinant of the equations of small motions. None if it can
        be another equation: it must have the same powers, and one slip must explain it.
        """
        sides = [one for one in formula.sides if one.text != "0"]
        letter, system = unknown[0].partition("_")[0], self._namespace.derivation.system
        has_place = 0 < len(system.q) <= MAX_INVERSE and not system.constraints
        if letter not in ROOTS or len(unknown) > 1 or not has_place or self._linear.place is None:
            return None
        if not 0 < len(sides) < len(formula.sides):
            return None
        x = system.qdot[0]  # for any number: no side contains velocities
        names = {**self._namespace.all_names, unknown[0]: x}
        try:
            values = [sp.expand(parse(side.text, names)) for side in sides]
            polynomials = [
                sp.Poly(value, x) for value in values if value.free_symbols & {*system.params}
            ]
        except (ExpressionError, NotImplementedError, TypeError, ValueError, sp.PolynomialError):
            return None
        if len(polynomials) < len(sides) or any(
            one.free_symbols_in_domain - {*system.params} for one in polynomials
        ):
            return None
        for determinant in self._determinants(letter, x):
            wrong = [k for k, one in enumerate(polynomials) if not _divides(one, determinant)]
            if not wrong:
                return plain("verified", formula, OF_DETERMINANT)
            side, own = sides[wrong[0]], polynomials[wrong[0]]
            if own.monoms() == determinant.monoms():
                for first, second in ((own.LC(), determinant.LC()), (own.TC(), determinant.TC())):
                    required = sp.expand(determinant.as_expr() * first / second)
                    result = self._roles.value(side, "determinant", required, {unknown[0]: x})
                    if len(result.verdict.corrections) == 1:
                        return result
        return None

    def _determinants(self, letter: str, x: sp.Symbol) -> Iterator[sp.Poly]:
        """Yield the determinants of small motions as polynomials of a letter."""
        M, D, K, _ = self._linear.matrices
        if letter in FREQUENCY_LETTERS:
            matrices = [] if any(D) else [K - x**2 * M]
        else:
            matrices = [x**2 * M + x * D + K, *([] if any(D) else [K - x * M, K + x * M])]
        yield from (sp.Poly(sp.expand(one.det()), x) for one in matrices)

    def _is_only_one(self, square: sp.Expr) -> bool:
        """Whether motions about the origin are stable, and forces have no other equilibrium.

        These are forces that depend on the coordinate alone but for a factor, as g sin(θ)/l does.
        """
        d = self._namespace.derivation
        (q,), (v,) = d.system.q, d.system.qdot
        force = -d.lagrangian.subs(v, 0).diff(q)
        is_known = bool(force) and sp.simplify(force / force.diff(q).subs(q, 0)) in (q, sp.sin(q))
        return self._linear.is_origin and is_known and not square.could_extract_minus_sign()


class Amplitudes:
    """Equations in A and B by the equations of motion with x = A*cos(w*t) and y = B*cos(w*t)."""

    def __init__(self, namespace: DocumentNamespace, linear: SmallMotions, roles: Roles) -> None:
        self._namespace, self._system = namespace, namespace.derivation.system
        self._linear, self._roles = linear, roles

    def verdict(self, formula: DocumentFormula, unknown: Sequence[str]) -> SideVerdict | None:
        """The verdict on an equation in unknown letters; None if it can be another equation."""
        if self._holds(formula):
            return plain("verified", formula, "with the stated functions of time")
        return self._refuted(formula, unknown)

    def _refuted(self, formula: DocumentFormula, unknown: Sequence[str]) -> SideVerdict | None:
        """The verdict `wrong` on one of (K - w**2 M) A = 0 that a single slip explains."""
        sides = [one for one in formula.sides if one.text != "0"]
        v, amplitudes = self._system.qdot[0], self._single_amplitudes
        letters = {str(s): q for s, q in amplitudes.items()}
        constants = {s.name for f in self._motions.values() for s in f.free_symbols}
        frequency = (constants - {*letters}) & {*formula.words}
        is_of_modes = len(frequency) == 1 and {*letters} <= {*unknown} <= {*letters} | frequency
        has_place = self._linear.is_origin and not self._system.conditions
        if len(formula.sides) != 2 or len(sides) != 1 or not is_of_modes or not has_place:
            return None
        letters[frequency.pop()] = v
        M, D, K, _ = self._linear.matrices
        try:
            own = sp.expand(parse(sides[0].text, {**self._namespace.all_names, **letters}))
        except (ExpressionError, NotImplementedError, TypeError, ValueError):
            return None
        if any(D) or not isinstance(own, sp.Expr):
            return None
        tried: dict[sp.Expr, int] = {}
        for row in (K - v**2 * M).tolist():
            equation = sp.expand(sp.Add(*map(sp.Mul, row, self._system.q)))
            for q, entry in zip(self._system.q, row, strict=True):
                factor = sp.cancel(own.diff(q) / entry) if entry != 0 else sp.S.Zero
                if factor and not factor.has(v, *self._system.q):
                    required = sp.expand(factor * equation)
                    tried[required] = len(sp.Add.make_args(sp.expand(own - required)))
        if not tried:
            return None
        nearest = min(tried, key=tried.__getitem__)
        result = self._roles.value(sides[0], "amplitudes", nearest, letters)
        return result if len(result.verdict.corrections) == 1 else None

    @cached_property
    def _single_amplitudes(self) -> dict[sp.Symbol, sp.Symbol]:
        """The amplitudes of coordinates that have one each, with equal functions of time."""
        result: dict[sp.Symbol, sp.Symbol] = {}
        functions = set[sp.Expr]()
        for q, value in self._motions.items():
            own = [s for s in self._amplitudes if value.has(s)]
            if len(own) == 1 and own[0] not in result:
                result[own[0]] = q
                functions.add(sp.expand(value / own[0]))
        return result if len(result) == len(self._system.q) and len(functions) == 1 else {}

    def _holds(self, formula: DocumentFormula) -> bool:
        """Whether a formula is one of these equations, or a sum or difference of two.

        It may be multiplied by a factor without amplitudes.
        """
        if len(formula.sides) != 2 or not self._equations:
            return False
        try:
            left, right = (self._value(one.text) for one in formula.sides)
        except (ExpressionError, NotImplementedError, TypeError, ValueError):
            return False
        names = self._amplitudes
        row = [(left - right).diff(one) for one in names]
        rest = (left - right).xreplace(dict.fromkeys(names, sp.S.Zero))
        moving = sp.Tuple(*row).free_symbols & {*names, *self._system.q, *self._system.qdot}
        if rest != 0 or moving or not any(row):
            return False
        rows = [[one.diff(name) for name in names] for one in self._equations]
        pairs = combinations(rows, 2)
        rows += [[a + s * b for a, b in zip(*pair, strict=True)] for pair in pairs for s in (1, -1)]
        columns = [*combinations(range(len(names)), 2)]
        return any(
            all(is_small(row[i] * one[j] - row[j] * one[i]) for i, j in columns)
            for one in rows
            if not all(map(is_small, one))  # such as the difference of two equal equations
        )

    def _value(self, text: str) -> sp.Expr:
        names = self._namespace.all_names
        value = parse(text, {**self._letters, **names})
        if not isinstance(value, sp.Expr) or isinstance(value, sp.MatrixBase):
            raise TypeError("a matrix")
        return value

    @cached_property
    def _letters(self) -> dict[str, sp.Symbol]:
        """Letters without a meaning, which are constants."""
        words = {word for one in self._namespace.formulas for word in one.words}
        unknown = words - {*self._namespace.all_names}
        return {word: sp.Symbol(word, positive=True) for word in sorted(unknown)}

    @cached_property
    def _motions(self) -> dict[sp.Symbol, sp.Expr]:
        """The functions of time that a document states all coordinates to be; empty for others."""
        return dict(self._stated())

    def _stated(self) -> Iterator[tuple[sp.Symbol, sp.Expr]]:
        names, system = self._namespace.all_names, self._system
        for formula in self._namespace.formulas:
            q = names.get(formula.subject)
            if q in system.q and len(formula.sides) == 2 and "t" in formula.words:
                with suppress(ExpressionError, NotImplementedError, TypeError, ValueError):
                    value = self._value(formula.sides[1].text)
                    if not depends_on(value, (*system.q, *system.qdot, *system.qddot)):
                        yield q, value

    @cached_property
    def _amplitudes(self) -> list[sp.Symbol]:
        """Constants that are factors of stated functions."""
        values = self._motions.values()
        return [
            s for s in self._letters.values()
            if any(one.has(s) and sp.expand(one - s * one.diff(s)) == 0 for one in values)
        ]  # fmt: skip

    @cached_property
    def _equations(self) -> list[sp.Expr]:
        """The equations of motion with the stated functions; none unless all are stated."""
        if {*self._motions} != {*self._system.q} or len(self._amplitudes) < len(self._motions):
            return []
        rates = along(self._system, self._motions)
        return [one.xreplace(rates) for one in self._namespace.derivation.euler_lagrange]


class StatedMotions:
    """Verdicts on coordinates and rates as functions of time."""

    def __init__(self, namespace: DocumentNamespace, linear: SmallMotions, roles: Roles) -> None:
        self._namespace, self._linear, self._roles = namespace, linear, roles

    def verdict(self, formula: DocumentFormula) -> SideVerdict | None:
        """The verdict on a function of time; None for other formulas.

        Functions of a coordinate and of its rate can contradict each other, although both solve the
        equations: the rate is wrong if the coordinate has initial values; else both are in doubt.
        """
        values = self._functions(formula)
        if not values:
            return None
        if self._is_solution(formula, values):
            if contrary := self._contrary(formula, values[0]):
                line, derivative = contrary
                if derivative is not None:
                    result = self._rate(formula.sides[-1], derivative)
                    if result is not None and result.verdict.corrections:
                        return result
                return plain("context", formula, opposed(line))
            several = "s" * (len(self._namespace.derivation.system.q) > 1)
            return plain("verified", formula, f"it solves the equation{several} of small motions")
        return plain("context", formula, "it prescribes a coordinate")

    def _is_solution(self, formula: DocumentFormula, values: Sequence[sp.Expr]) -> bool:
        is_single = all(map(self._linear.is_solution, values))
        return is_single or self._linear.is_motion(self._beside(formula))

    def _contrary(
        self, formula: DocumentFormula, value: sp.Expr
    ) -> tuple[int, sp.Expr | None] | None:
        """The line of a motion that has another rate, or of a rate of another motion.

        Both have the same letters. With the rate of the motion if this has initial values, which
        are letters.
        """
        name = formula.sides[0].text
        q, is_rate, result = stem(name), order(name) == 1, None
        for other in self._namespace.formulas:
            if {name, other.sides[0].text} != {q, f"{q}_dot"}:
                continue
            for found in self._functions(other)[:1]:
                motion, rate = (found, value) if is_rate else (value, found)
                if not (motion.has(TIME) and rate.has(TIME)):
                    continue
                derivative = motion.diff(TIME)
                if not is_nonzero(derivative - rate):
                    return None
                if derivative.free_symbols != rate.free_symbols:
                    continue  # another case, or other constants
                has_start = has_initial_values(motion)
                if is_rate or not has_start:
                    result = other.occurrence.line, derivative if has_start else None
        return result

    def _rate(self, side: FormulaText, value: sp.Expr) -> SideVerdict | None:
        """The verdict on a side that must be a function of time.

        Coordinates and velocities, which it does not contain, stand for constants that are no
        parameters; None if there are more of these.
        """
        system, names = self._namespace.derivation.system, self._namespace.all_names
        constants = sorted({*WORD.findall(side.text)} - names.keys())
        symbols = (*system.q, *system.qdot)
        if len(constants) > len(symbols):
            return None
        letters = dict(zip(constants, symbols, strict=False))
        known = {sp.Symbol(name, positive=True): one for name, one in letters.items()}
        return self._roles.value(side, "rate", value.xreplace(known), letters)

    def _functions(self, formula: DocumentFormula) -> list[sp.Expr]:
        """The functions of time that a formula states a coordinate or its rate to be, as φ = ω t.

        Further sides are other forms of the function, as its number in φ̇ = ω = 3.
        """
        system, names = self._namespace.derivation.system, self._namespace.all_names
        first, *others = formula.sides
        if not others or {*formula.relations} != {"="}:
            return []
        if names.get(first.text) not in (*system.q, *system.qdot):
            return []
        if is_motion_of_several(formula):
            others = others[-1:]
        with suppress(ExpressionError):
            moving = (*system.q, *system.qdot, *system.qddot, *system.p)
            words = {word for side in others for word in WORD.findall(side.text)}
            # letters without a meaning, such as ω, are constants
            constants = {one: sp.Symbol(one, positive=True) for one in words - names.keys()}
            values = [parse(side.text, {**names, **constants}) for side in others]
            if all(
                not isinstance(value, sp.MatrixBase)
                and (TIME in value.free_symbols or not depends_on(value, moving))
                for value in values
            ):
                return values
        return []

    def _beside(self, formula: DocumentFormula) -> dict[sp.Symbol, sp.Expr]:
        """The functions of time of coordinates in a formula and in those next to it.

        There are none of a coordinate for which these state two.
        """
        names, system = self._namespace.all_names, self._namespace.derivation.system
        formulas, result = self._namespace.formulas, dict[sp.Symbol, sp.Expr]()
        if formula not in formulas:  # another form of one of them
            return result
        place = formulas.index(formula)
        rows = formulas[:place][::-1], formulas[place + 1 :]
        for one in (formula, *chain(*(takewhile(self._functions, row) for row in rows))):
            value = self._functions(one)[0]
            for side in one.sides[: -1 if is_motion_of_several(one) else 1]:
                q = names.get(side.text.removeprefix("-"))
                if q in system.q and len(result) < len(system.q):
                    result.setdefault(q, -value if side.text.startswith("-") else value)
        return result


def _named(formula: DocumentFormula) -> tuple[str, tuple[DocumentFormula, int]]:
    """The name to a power of which a formula gives a value, with the formula and the power."""
    square = SQUARE.fullmatch(formula.sides[0].text)
    return (square[1], (formula, 2)) if square else (formula.subject, (formula, 1))


def _divides(one: sp.Poly, other: sp.Poly) -> bool:
    """Whether a polynomial that is no number is a factor of another one."""
    return one.degree() > 0 and all(sp.simplify(c) == 0 for c in sp.rem(other, one).coeffs())
