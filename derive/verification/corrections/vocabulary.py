"""Factors that corrections of a formula can contain: those of the formula, and the derived ones."""

import ast
from collections.abc import Collection, Iterable
from functools import cached_property

import sympy as sp

from derive.verification.corrections.monomials import Factor
from derive.verification.corrections.source_names import SourceNames
from derive.verification.corrections.state_samples import StateSamples
from derive.verification.judging.reference_system import depends_on

#: The number and the most operations of derived sums that are tried as factors.
SUMS, SHORT = 12, 8
#: Tried multiples of angles.
MULTIPLES = (1, 2, 3, sp.Rational(1, 2))
WAVES = (sp.sin, sp.cos)


class Vocabulary:
    """Names, functions and sums in the names of a formula, with their values."""

    def __init__(
        self,
        names: SourceNames,
        samples: StateSamples,
        brackets: Iterable[str],
        derived: sp.Basic,
        foreign: Collection[sp.Symbol],
    ) -> None:
        self._names, self._samples, self._foreign = names, samples, foreign
        self._brackets = [names.parse(text) for text in dict.fromkeys(brackets)]
        self._derived = names.write(derived)
        calls = (ast.unparse(node) for node in names.nodes() if isinstance(node, ast.Call))
        self._calls = [names.parse(text) for text in dict.fromkeys(calls)]

    @cached_property
    def factors(self) -> list[Factor]:
        """Those of the formula first: of several that depend on each other, the first is kept."""
        sums = [one for one in self._derived.atoms(sp.Add) if one.count_ops() <= SHORT]
        sums.sort(key=lambda one: (one.count_ops(), str(one)))
        expressions = [
            *self._names.names,
            *self._calls,
            *(wave(argument) for argument in self._arguments for wave in WAVES),
            *self._brackets,
            *self._names.symbols.values(),
            *sums[:SUMS],
        ]
        factors = (self._factor(one) for one in dict.fromkeys(expressions) if not one.is_number)
        return [one for one in factors if self._is_own(one.expression)]

    def waves_like(self, text: str) -> list[Factor]:
        """Sines and cosines of an angle with other signs, multiples or coordinates."""
        own = self._names.parse(text)
        if not isinstance(own, WAVES):
            return []
        (whole,) = own.args
        arguments = [whole]
        for term in sp.Add.make_args(whole):
            number, angle = term.as_coeff_Mul()
            others = self._angles if angle in self._angles else []
            changed = [-term, sp.S.Zero, *(n * angle for n in MULTIPLES)]
            changed += [number * other for other in others]
            arguments += [whole - term + one for one in changed]
        arguments += [whole + n * angle for angle in self._angles for n in (1, -1, 2, -2)]
        waves = dict.fromkeys(wave(argument) for argument in arguments for wave in WAVES)
        # another sign is that of the whole term
        return [self._factor(wave) for wave in waves if wave not in (own, -own)]

    def _is_own(self, expression: sp.Expr) -> bool:
        return not depends_on(self._names.meaning(expression), self._foreign)

    def _factor(self, expression: sp.Expr) -> Factor:
        return Factor(expression, self._samples(self._names.meaning(expression)))

    @cached_property
    def _arguments(self) -> list[sp.Expr]:
        """Arguments of sines and cosines, those of the formula first."""
        derived = sorted(self._derived.atoms(*WAVES), key=sp.default_sort_key)
        waves = [call for call in self._calls if isinstance(call, WAVES)] + derived
        return [*dict.fromkeys(wave.args[0] for wave in waves)]

    @cached_property
    def _angles(self) -> list[sp.Symbol]:
        return sorted({s for a in self._arguments for s in a.free_symbols}, key=str)
