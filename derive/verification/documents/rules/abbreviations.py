"""Names that a document defines wrongly, as the formulas that contain them show."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress

import sympy as sp

from derive.formulas.expression import parse
from derive.formulas.syntax import ExpressionError
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.statements import DocumentFormula

#: Formulas that must agree on the value of a name, unless its slip is one of a factor.
AGREEING = 2


def differs_by_one_factor(own: sp.Expr, value: sp.Expr) -> bool:
    """Whether two sums have the same terms, one of them with another factor, as of a slip."""
    terms = [sp.expand(one).as_coefficients_dict() for one in (own, value)]
    same = [terms[0][key] == terms[1][key] for key in terms[0]]
    return {*terms[0]} == {*terms[1]} and any(same) and same.count(False) == 1


class Abbreviations:
    """Values that names must have for several known quantities to be right."""

    def __init__(self, namespace: DocumentNamespace, formulas: Sequence[DocumentFormula]) -> None:
        self._namespace = namespace
        #: Correct values of wrongly defined names.
        self._required: dict[str, sp.Expr] = {}
        for name in [*namespace.defining]:
            own = namespace.names[name]
            if not isinstance(own, sp.MatrixBase):
                values = [*self._values(name, formulas)]
                shortest = min(values, key=sp.count_ops, default=own)
                others = {*namespace.defining} - {name}
                is_alone = not any(name in one.words and others & {*one.words} for one in formulas)
                is_slip = is_alone and differs_by_one_factor(own, shortest)
                is_shown = len(values) >= AGREEING or is_slip
                is_agreed = is_shown and self._are_equal([shortest, *values])
                # a name that must be 0 is one that a known system has not
                if is_agreed and shortest != 0 and not self._are_equal([own, shortest]):
                    self._required[name] = shortest
        if self._required:
            namespace.correct(self._required)

    def required(self, name: str) -> sp.Expr | None:
        """The value of a name with a wrong definition; None for others."""
        return self._required.get(name)

    def _values(self, name: str, formulas: Sequence[DocumentFormula]) -> Iterator[sp.Expr]:
        """The values of a name with which formulas about known quantities that contain it hold."""
        names, symbol = self._namespace.all_names, sp.Dummy(real=True)
        scope: Mapping[str, object] = {**names, name: symbol}
        momenta = self._namespace.model.momenta
        system = self._namespace.derivation.system
        moving = {*system.q, *system.qdot, *system.qddot}
        allowed = names[name].free_symbols | {*system.params}
        for formula in formulas:
            subject = formula.subject
            known = subject in names and subject not in self._namespace.defining
            if not known or name not in formula.words:
                continue
            with suppress(ExpressionError, NotImplementedError, ValueError, TypeError):
                side = parse(formula.sides[-1].text, scope)
                difference = sp.expand((side - names[subject]).xreplace(momenta))
                slope = difference.diff(symbol)
                if slope == 0 or slope.has(symbol):
                    continue
                value = sp.cancel(-difference.xreplace({symbol: sp.S.Zero}) / slope)
                if (value.free_symbols & moving) <= allowed:
                    yield sp.factor_terms(value)

    def _are_equal(self, values: Sequence[sp.Expr]) -> bool:
        first, *others = values
        return all(self._namespace.model.context.is_zero(one - first) for one in others)
