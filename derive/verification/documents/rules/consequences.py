"""Verdicts in the light of others: what follows from a wrong formula, and which stand.

No right formula is to be called wrong: a verdict without enough evidence becomes `context`.
"""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import combinations

import sympy as sp

from derive.formulas.expression import FUNCTIONS, parse
from derive.formulas.generic_values import is_nonzero
from derive.formulas.syntax import ExpressionError
from derive.system.symbols import TIME
from derive.verification.documents.formula_translation import order, stem
from derive.verification.documents.letters.candidates import SystemCandidate
from derive.verification.documents.letters.document_system import derivation
from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.side_verdict import SideVerdict, plain
from derive.verification.documents.statements import POINT, WORD, DocumentFormula
from derive.verification.judging.engine import joined
from derive.verification.judging.reference_system import time_derivative
from derive.verification.judging.verdict import Correction

#: Kinds of formulas that no other case of the system gives.
OF_ENERGIES = ("kinetic_energy", "potential_energy", "lagrangian", "energy", "hamiltonian")
#: The note on a formula that follows correctly from a wrong one.
FOLLOWS = "it follows from line"
#: The note on a Lagrangian of fewer coordinates, from which others can follow.
SUBSTITUTED = "with the constraints substituted"
#: Energies from which others follow.
ENERGIES = ("kinetic_energy", "potential_energy", "lagrangian")

#: The reason of a verdict on a single formula that holds with an unusual meaning of angles alone.
UNSTATED = "it holds with angles from the horizontal alone, which nothing states: use --names"
#: The note on a formula whose dimensions contradict those of all others.
INHOMOGENEOUS = "its dimensions contradict those of all other formulas"
#: The note on a rate that contradicts any position.
NO_RATE = "nothing that depends on the coordinates has this rate"
UNDECIDED = "nothing else in the document decides which of them is wrong"
#: The reason of a verdict that a system without enough support gives.
UNSUPPORTED = (
    "it does not hold for the system that fits best, but this fits too few other formulas to call "
    "it wrong: state the system by --system"
)

#: The reason of a verdict on an equation that differs from other equations.
OTHER_CASE = "it can be another case, or one of these can be wrong"

WithVerdict = tuple[DocumentFormula, SideVerdict]


@dataclass(frozen=True)
class Contradictions:
    """What contradicts the verdicts by a system, by the numbers of formulas."""

    #: Formulas that do not hold, and those that state another system with which they do.
    doubts: Mapping[int, frozenset[int]] = field(default_factory=dict)
    #: Formulas that hold, and those that do not hold unless these are wrong.
    disputed: Mapping[int, frozenset[int]] = field(default_factory=dict)
    #: The one formula whose dimensions contradict those of all others.
    inhomogeneous: int | None = None
    #: The rates that it lacks.
    lost_dots: tuple[Correction, ...] = ()


@dataclass(frozen=True)
class _Source:
    """A wrong energy: the line of its formula, and the Lagrangian that it gives."""

    line: int
    lagrangian: sp.Expr


class Consequences:
    """The formulas of a document that follow from its own energies, which can be wrong."""

    def __init__(self, namespace: DocumentNamespace) -> None:
        self._namespace, self._context = namespace, namespace.model.context

    def marked(self, verdicts: Sequence[WithVerdict]) -> list[WithVerdict]:
        """The verdicts, with a note on wrong formulas that follow from a wrong one before them.

        Those that follow from a Lagrangian with the constraints substituted are right.
        """
        reduced: _Source | None = None
        values = {kind: getattr(self._namespace.derivation, kind) for kind in ENERGIES}
        source: _Source | None = None
        result: list[WithVerdict] = []
        for formula, verdict in verdicts:
            if verdict.verdict.note == SUBSTITUTED:
                value = self._written(formula)
                reduced = None if value is None else _Source(formula.occurrence.line, value)
            if verdict.verdict.verdict == "wrong" and reduced and self._follows(formula, reduced):
                verdict = plain("verified", formula, f"{FOLLOWS} {reduced.line}")
            elif verdict.verdict.verdict == "wrong" and source and self._follows(formula, source):
                note = joined(verdict.verdict.note, f"{FOLLOWS} {source.line}")
                verdict = replace(verdict, verdict=replace(verdict.verdict, note=note))
            elif verdict.verdict.verdict == "wrong" and verdict.kind in ENERGIES:
                value = self._written(formula)
                if value is not None:
                    values[verdict.kind] = value
                    L = values["kinetic_energy"] - values["potential_energy"]
                    own = value if verdict.kind == "lagrangian" else L
                    source = _Source(formula.occurrence.line, own)
            result.append((formula, verdict))
        return result

    def _written(self, formula: DocumentFormula) -> sp.Expr | None:
        """The value of the last side of a formula."""
        with suppress(ExpressionError):
            value = self._namespace.value(formula.sides[-1].text)
            return None if isinstance(value, sp.MatrixBase) else value
        return None

    def _follows(self, formula: DocumentFormula, source: _Source) -> bool:
        value, subject = self._written(formula), formula.subject
        if value is None:
            return False
        try:
            if subject in self._namespace.letters.quantities or subject.isidentifier():
                required = self._required(subject, source.lagrangian)
                if required is not None and self._context.is_zero(value - required):
                    return True
            return self._is_equation(formula, source.lagrangian)
        except (ExpressionError, NotImplementedError):
            return False

    def _required(self, name: str, lagrangian: sp.Expr) -> sp.Expr | None:
        """The value of a name that follows from a Lagrangian."""
        system, letters = self._namespace.derivation.system, self._namespace.letters
        if letters.quantities.get(name) == "lagrangian":
            return lagrangian
        operand, variables = self._namespace.derivatives.get(name, ("", ()))
        if letters.quantities.get(operand) == "lagrangian" and len(variables) == 1:
            variable = self._namespace.all_names.get(variables[0])
            return lagrangian.diff(variable) if isinstance(variable, sp.Symbol) else None
        coordinate = self._namespace.all_names.get(letters.momenta.get(name, ""))
        if coordinate in system.q:
            return lagrangian.diff(system.qdot[system.q.index(coordinate)])
        if letters.quantities.get(name) in ("energy", "hamiltonian"):
            pairs = ((v, lagrangian.diff(v)) for v in system.qdot)
            return sp.Add(*(v * p for v, p in pairs)) - lagrangian
        return None

    def _is_equation(self, formula: DocumentFormula, lagrangian: sp.Expr) -> bool:
        """Whether a formula is an equation of motion of a Lagrangian, times any factor."""
        system = self._namespace.derivation.system
        left, right = (
            self._namespace.value(one.text) for one in (formula.sides[0], formula.sides[-1])
        )
        difference = left - right
        for q, v, force in zip(system.q, system.qdot, system.applied, strict=True):
            rate = time_derivative(system, lagrangian.diff(v))
            equation = rate - lagrangian.diff(q) - force
            for a in system.qddot:
                factors = equation.diff(a), difference.diff(a)
                if all(factors):
                    cross = difference * factors[0] - equation * factors[1]
                    if self._context.is_zero(cross):
                        return True
                    break
        return False


def weighed(
    results: Sequence[WithVerdict],
    candidate: SystemCandidate,
    contradictions: Contradictions,
    is_stated: bool,
    is_partial: bool = False,
) -> Iterator[WithVerdict]:
    """Yield the verdicts, with `context` for formulas that are wrong by too weak evidence.

    A formula is wrong by a system that the user states, or that follows from positions or energies
    in the document. It is not if other formulas of the document fit the rest as well and agree with
    it, in which case neither these nor what holds with them alone is verified; nor if one of
    several wrong ones is an energy that is stated correctly elsewhere, as for another case; nor if
    it is the rate of a position that a system of energies or equations does not contain. A system
    that is known from elsewhere must have a letter for each of its parameters in formulas that are
    judged, unless that is a factor of the Lagrangian, such as the mass of a single body, and the
    accelerations as written have no potential of their own; a letter for several of them, such as
    for both masses, in a formula that holds; and no more formulas with more than one wrong term, or
    slips if one is in an energy, than half of those that hold, of which there must be one. With a
    partial search for it, none is wrong. A formula whose dimensions contradict those of all others
    needs no more evidence if one term is wrong.
    """
    lines = {k: formula.occurrence.line for k, (formula, _) in enumerate(results)}
    wrong = [one.verdict for _, one in results if one.verdict.verdict == "wrong"]
    misfits = sum(FOLLOWS not in one.note and len(one.corrections) != 1 for one in wrong)
    holding = sum(one.verdict.verdict in ("verified", "equivalent") for _, one in results)
    is_known = candidate.basis == "catalogue" and not is_stated
    lacking = {*_lacking(results, candidate)}
    has_all = not lacking or (
        misfits == 0 < holding
        and lacking == {*_scales(candidate, lacking)}
        and not _is_conservative([formula for formula, _ in results])
    )
    # an energy and an equation that contradict the system alike speak against the system
    terms = {tuple(t.wrong for t in one.corrections) for one in wrong if FOLLOWS not in one.note}
    has_energy = any(
        one.verdict.verdict == "wrong" and one.kind in OF_ENERGIES for _, one in results
    )
    slips = max(misfits, len(terms) if has_energy else 0)
    few = max(1, min(holding, max(2, holding // 2)))
    is_several = has_energy and len(wrong) > 1
    has_none = holding == 0 and (is_several or bool(candidate.constraints))
    is_weak = is_known and (is_partial or not has_all or has_none or slips > few)
    is_guess = is_known and holding < 2 and candidate.is_turned
    independent = sum(FOLLOWS not in one.note for one in wrong)
    # an energy that is stated again, with other equations: those of another case
    held = {
        formula.subject
        for k, (formula, one) in enumerate(results)
        if k in candidate.stating or one.verdict.verdict in ("verified", "equivalent")
    }
    is_open = not is_stated and candidate.basis in ("energies", "catalogue")
    has_cases = is_open and len(wrong) > 1 and any(
        one.verdict.verdict == "wrong" and one.kind in OF_ENERGIES and formula.subject in held
        for k, (formula, one) in enumerate(results)
        if k not in candidate.stating and formula.subject
    )  # fmt: skip
    is_tie = candidate.is_of_equations and (independent != 1 or holding < 2 or misfits > 0)
    given = _lines(lines[k] for k in candidate.stating)
    undecided = {*_of_friction(results, candidate)}
    # rates of positions, or of other names, of which nothing in a system shows that they hold
    shown = {w for formula, one in results if one.verdict.verdict == "verified"
             for w in formula.words}  # fmt: skip
    counts = Counter(candidate.parameters.values())
    unsure = {letter for letter, n in counts.items() if is_known and n > 1 and letter not in shown}
    unused = {
        f"{formula.subject}_dot": lines[k]
        for k, (formula, one) in enumerate(results)
        if (candidate.stating or (is_known and not POINT.match(formula.subject)))
        and one.verdict.verdict == "definition"
        and k not in candidate.stating
        and formula.subject not in shown
    }
    for number, (formula, result) in enumerate(results):
        verdict = result.verdict
        is_inhomogeneous = number == contradictions.inhomogeneous
        if is_inhomogeneous and verdict.verdict == "wrong" and len(verdict.corrections) == 1:
            note = joined(verdict.note, INHOMOGENEOUS)
            note = joined(note, f"given {given}") if given else note
            result = replace(result, verdict=replace(verdict, note=note))
        elif is_inhomogeneous and verdict.verdict != "wrong" and contradictions.lost_dots:
            result = of_lost_dots(formula, contradictions)
        elif is_inhomogeneous and verdict.verdict == "definition":
            result = plain("context", formula, INHOMOGENEOUS)
        elif verdict.verdict == "wrong" and _is_no_rate(formula, candidate):
            result = replace(result, verdict=replace(verdict, note=joined(verdict.note, NO_RATE)))
        elif is_guess and verdict.verdict in ("verified", "equivalent", "wrong"):
            result = plain("context", formula, UNSTATED)
        elif verdict.verdict in ("verified", "equivalent") and number in contradictions.disputed:
            note = opposed(lines[min(contradictions.disputed[number])])
            result = plain("context", formula, note)
        elif verdict.verdict == "wrong" and contradictions.inhomogeneous in candidate.stating:
            line = lines[contradictions.inhomogeneous or 0]
            result = plain("context", formula, opposed(line))
        elif verdict.verdict == "wrong" and number in contradictions.doubts:
            other = _lines(lines[k] for k in contradictions.doubts[number] - {number})
            beside = f" and agrees with {other}" if other else ""
            note = f"it contradicts {given or 'the system'}{beside}: {UNDECIDED}"
            result = plain("context", formula, note)
        elif verdict.verdict == "wrong" and formula.subject in unused:
            result = plain("context", formula, opposed(unused[formula.subject]))
        elif verdict.verdict == "wrong" and number in undecided:
            result = plain("context", formula, f"it contradicts the stated friction: {UNDECIDED}")
        elif verdict.verdict == "wrong" and has_cases:
            result = plain("context", formula, f"it differs from {given or 'others'}: {OTHER_CASE}")
        elif verdict.verdict == "wrong" and (is_weak or unsure & {*formula.words}):
            result = plain("context", formula, UNSUPPORTED)
        elif verdict.verdict == "wrong" and (
            _is_driven(candidate)
            if result.kind in OF_ENERGIES and len(verdict.corrections) == 1
            else is_tie or _adds_letters(formula, result, candidate)
        ):
            result = plain("context", formula, f"it differs from {given or 'others'}: {OTHER_CASE}")
        elif verdict.verdict == "wrong" and given:
            note = joined(verdict.note, f"given {given}")
            result = replace(result, verdict=replace(verdict, note=note))
        yield formula, result


def of_lost_dots(formula: DocumentFormula, contradictions: Contradictions) -> SideVerdict:
    """The verdict on a formula that lacks dots, which its dimensions alone show."""
    result = plain("wrong", formula, INHOMOGENEOUS)
    verdict = replace(result.verdict, corrections=contradictions.lost_dots)
    return replace(result, verdict=verdict, parts=((0, formula.sides[-1]),))


def _is_no_rate(formula: DocumentFormula, candidate: SystemCandidate) -> bool:
    """Whether a formula states the rate of a component of a position that no function has.

    Coordinates whose rates it does not contain can be constant there.
    """
    name = formula.subject.removesuffix("_dot")
    if name == formula.subject or not POINT.match(name) or name in candidate.coordinates:
        return False
    words = {*candidate.coordinates, *(f"{q}_dot" for q in candidate.coordinates)}
    words |= candidate.letters - {"t"}
    if not {*WORD.findall(formula.sides[-1].text)} <= {*words, *FUNCTIONS, "t"}:
        return False  # such as speeds by name
    symbols = {word: sp.Symbol(word) for word in words}
    try:
        value = parse(formula.sides[-1].text, {**symbols, **FUNCTIONS, "t": TIME})
    except ExpressionError:
        return False
    pairs = [(symbols[q], symbols[f"{q}_dot"]) for q in candidate.coordinates]
    if not isinstance(value, sp.Expr):
        return False
    slopes = [(q, value.diff(v)) for q, v in pairs]
    if any(is_nonzero(slope.diff(v)) for _, slope in slopes for _, v in pairs):
        return True
    resting = value.xreplace({v: sp.S.Zero for _, v in pairs})
    if any(is_nonzero(resting.diff(q)) for q, _ in pairs):  # a term has lost its rate
        return True
    slopes = [(q, slope) for q, slope in slopes if slope] + [(TIME, resting)]
    return any(is_nonzero(a.diff(p) - b.diff(q)) for (q, a), (p, b) in combinations(slopes, 2))


def _is_driven(candidate: SystemCandidate) -> bool:
    """Whether equations of a driven motion state the system, which leave its energies open."""
    return candidate.is_of_equations and candidate.system.potential_energy.has(TIME)


def _of_friction(results: Sequence[WithVerdict], candidate: SystemCandidate) -> Iterator[int]:
    """Yield the numbers of wrong formulas that differ in friction of Rayleigh's function.

    This can be wrong, too: it is right if it leads to other formulas that contain its letters.
    """
    if candidate.basis not in ("positions", "energies"):
        return
    names = {symbol.name for symbol in sp.Tuple(*candidate.system.forces).free_symbols}
    letters = {letter for name, letter in candidate.parameters.items() if name in names}
    supported = {
        word
        for formula, one in results
        if one.verdict.verdict in ("verified", "equivalent") and formula.subject not in letters
        for word in formula.words
    }
    for number, (formula, result) in enumerate(results):
        if result.verdict.verdict == "wrong":
            terms = [
                text for one in result.verdict.corrections for text in (one.wrong, one.correct)
            ]
            words = {w for text in terms for w in WORD.findall(text)} or {*formula.words}
            own = words & letters
            if own and not own <= supported:
                yield number


def _adds_letters(
    formula: DocumentFormula, result: SideVerdict, candidate: SystemCandidate
) -> bool:
    """Whether a correction has forces or friction that a formula, as of a case without, has not.

    Of a system that equations state, these are all letters.
    """
    terms = [one for one in result.verdict.corrections if one.correct != f"{one.wrong}_dot"]
    added = {w for one in terms for w in WORD.findall(one.correct)}  # but for a lost dot
    loads = {name for name, _ in (*candidate.forces, *candidate.friction)}
    return bool(
        (added - {*formula.words, *FUNCTIONS}) & (added if candidate.is_of_equations else loads)
    )


def _lacking(results: Sequence[WithVerdict], candidate: SystemCandidate) -> Iterator[str]:
    """The parameters of a system that have no number, and no letter in a formula that is judged.

    A letter of other formulas alone can be one of another system.
    """
    judged = {w for formula, one in results if one.verdict.verdict != "context"
              for w in formula.words}  # fmt: skip
    known = {name for name, letter in candidate.parameters.items() if letter in judged}
    known |= {*candidate.numbers}
    return (p.symbol.name for p in candidate.system.parameters if p.symbol.name not in known)


def _scales(candidate: SystemCandidate, names: Collection[str]) -> Iterator[str]:
    """Those that drop out of the equations of motion: factors of the Lagrangian."""
    system = candidate.system
    if any(system.applied) or candidate.forces or candidate.friction:
        return
    for name in names:
        symbol = next(p.symbol for p in system.parameters if p.symbol.name == name)
        if not sp.expand(derivation(system).lagrangian / symbol).has(symbol):
            yield name


def _is_conservative(formulas: Sequence[DocumentFormula]) -> bool:
    """Whether accelerations that formulas state are the gradient of a potential energy."""
    words = {word for formula in formulas for word in formula.words}
    symbols = {word: sp.Symbol(word, positive=True) for word in words}
    rows = {stem(one.subject): one.sides[-1].text for one in formulas if order(one.subject) == 2}
    try:
        values = {q: parse(text, {**symbols, **FUNCTIONS}) for q, text in rows.items()}
    except ExpressionError:
        return False
    if any(order(str(symbol)) for value in values.values() for symbol in value.free_symbols):
        return False
    point = {symbols[word]: sp.Rational(k + 7, k + 5) for k, word in enumerate(sorted(words))}
    q = {name: sp.Symbol(name, positive=True) for name in rows}
    curls = (values[a].diff(q[b]) - values[b].diff(q[a]) for a, b in combinations(rows, 2))
    return all(abs(one.subs(point).evalf(30)) < 1e-20 for one in curls)


def opposed(line: int) -> str:
    """The note on a formula that contradicts another one, which can be wrong as well."""
    return f"it contradicts line {line}: {UNDECIDED}"


def _lines(numbers: Iterable[int]) -> str:
    """Lines in words."""
    words = [*map(str, sorted({*numbers}))]
    if not words:
        return ""
    *first, last = words
    return f"lines {', '.join(first)} and {last}" if first else f"line {last}"
