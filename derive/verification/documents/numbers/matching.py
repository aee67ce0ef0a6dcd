"""How many formulas of a document hold for each meaning of its letters, in numbers.

All candidates of a system are evaluated at once: only accelerations, momenta and energies differ
between them.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from math import inf

import numpy as np
from numpy.typing import NDArray

from derive.verification.documents.formula_translation import order, stem
from derive.verification.documents.letters.candidates import SystemCandidate
from derive.verification.documents.letters.letters import Letters
from derive.verification.documents.numbers.candidate_motions import (
    ArbitraryMotion,
    CandidateMotions,
)
from derive.verification.documents.numbers.numbers import Numbers, Votes
from derive.verification.documents.statements import (
    POINT,
    Derivatives,
    DocumentFormula,
    without_unknown_terms,
)

#: The worth of a formula that holds but for one term.
NEARLY = 0.5
#: How much it speaks against a meaning that angles are not those from hanging.
UNUSUAL = 0.25
#: How much a formula that does not hold speaks against a meaning, and a parameter of a system
#: that has no letter.
FAILING, LACKING = 0.5, 0.25
#: Comparisons that suffice for a system of which all hold.
ENOUGH = 4
#: Comparisons of a document in which such formulas are considered.
FEW = 12
#: A sine or cosine of an angle, and relations of an approximation.
OF_ANGLE, NEAR = re.compile(r"\b(?:sin|cos)\((\w+)"), ("~", "->")
#: Most candidates of a system that are considered beside the best.
MAX_RIVALS = 6

#: A comparison: its formula's number, and the text of a side.
Comparison = tuple[int, str]


@dataclass(frozen=True)
class Match:
    """A candidate, how many comparisons hold with it, and how many were possible."""

    candidate: SystemCandidate
    holding: float
    compared: int
    #: Numbers of formulas that do not hold, and whether each holds but for one term.
    failed: frozenset[int] = frozenset()
    is_nearly: bool = True
    #: Numbers of formulas that no other term makes hold, where these were tried.
    unexplained: frozenset[int] = frozenset()
    #: Alike for candidates of the same motions and energies.
    signature: bytes = b""
    #: Comparisons that hold because they state the system.
    stating: int = 0
    #: Whether each formula was compared, but for those that hold whatever the motion is.
    is_of_all_formulas: bool = False

    @property
    def support(self) -> float:
        """Formulas that hold, less some of those that do not."""
        holding = self.holding - LACKING * self.candidate.lacking
        return holding - FAILING * (self.compared - self.holding)

    @property
    def is_circular(self) -> bool:
        """Whether only the equations hold that state the system."""
        return self.candidate.is_of_equations and self.holding <= len(self.candidate.stating)

    @property
    def is_stated_by_positions(self) -> bool:
        """Whether positions of the document state the system, and all its formulas hold."""
        is_full = self.compared >= ENOUGH and not self.failed
        return self.candidate.basis == "positions" and is_full

    @property
    def is_complete(self) -> bool:
        """Whether all formulas hold with a known system in its usual form and all its letters."""
        one, is_full = self.candidate, self.is_of_all_formulas and not self.failed
        has_all = not (one.lacking or one.numbers)
        return is_full and has_all and one.is_usual and one.basis == "catalogue"

    @property
    def is_refuted_by_one(self) -> bool:
        """Whether one formula alone does not hold, beside those that state the system."""
        return len(self.failed) == 1 and self.failed.isdisjoint(self.candidate.stating)

    @property
    def score(self) -> float:
        """The support, less for a convention that is not the usual one."""
        return self.support - UNUSUAL * (not self.candidate.is_usual)


def trivial_comparisons(
    letters: Letters, formulas: Sequence[DocumentFormula], derivatives: Derivatives
) -> frozenset[Comparison]:
    """Comparisons that hold whatever the motion is, such as those of a definition."""
    numbers = Numbers(ArbitraryMotion(letters), letters, derivatives)
    numbers.define(formulas)
    result: dict[Comparison, bool] = {}
    for index, formula in enumerate(formulas):
        for side, vote in numbers.comparisons(formula):  # for a matrix, those of all its entries
            result[index, side] = result.get((index, side), True) and bool(vote.all())
    return frozenset(one for one, holds in result.items() if holds)


def best_matches(
    tried: Sequence[SystemCandidate],
    letters: Letters,
    formulas: Sequence[DocumentFormula],
    derivatives: Derivatives,
    trivial: frozenset[Comparison],
    least_support: float = -inf,
) -> list[Match]:
    """The candidates of one system that can be meant, the best first.

    These are the one for which most formulas hold, others with the same support, and usual ones
    for which a few formulas fail by one term each; of those of the same motions the first. There
    are none if all have less than the `least_support`.
    """
    if not tried:
        return []
    numbers = Numbers(CandidateMotions(tried, letters), letters, derivatives)
    numbers.define(formulas)
    others = {w for one in formulas if not (_is_equation(one) or one.is_value) for w in one.words}
    loads = {*letters.of_kind("force")} - others
    free = {k: _without_loads(tried, loads, one) for k, one in enumerate(formulas)}
    left_out = _linearised(formulas) | _of_special_motions(tried, letters, formulas)
    votes = [
        (index, side, vote)
        for index, formula in enumerate(formulas)
        if index not in left_out and index not in tried[0].given
        for side, vote in _comparisons(numbers, formula, *free[index])
        if (index, side) not in trivial
    ]
    if not votes:
        return []
    agreeing = np.array([vote for *_, vote in votes])
    failing = len(votes) - int(agreeing.sum(axis=0).max())
    if len(votes) - failing * (1 - NEARLY) * (1 + FAILING) < least_support:
        return []  # even if all others hold but for one term
    near, unexplained = np.zeros_like(agreeing), np.zeros_like(agreeing)
    uses_letters = cache(partial(_uses_letters, tried))
    are_few = len(votes) <= FEW
    if are_few or (len(tried) == 1 and tried[0].is_of_equations):
        for row, (index, side, vote) in enumerate(votes):
            written = frozenset(formulas[index].words) & {*letters.parameters}
            possible = ~vote & uses_letters(written)
            sides = formulas[index].sides[0].text, side
            rest, lacking = free[index]
            if lacking.all():
                possible, sides = ~vote, (rest.sides[0].text, rest.sides[1].text)
            if possible.any() and (hits := numbers.is_near(*sides)) is not None:
                near[row], unexplained[row] = hits & possible, possible & ~hits
    near &= are_few
    holding = agreeing.sum(axis=0) + NEARLY * near.sum(axis=0)
    usual = np.array([one.is_usual for one in tried])
    score = holding - UNUSUAL * ~usual
    best = int(np.argmax(score))  # the first of several: the likeliest
    is_nearly = np.all(agreeing | near, axis=0)
    is_rival = (holding >= holding[best]) | (usual & is_nearly)
    ranked = [best, *sorted(map(int, np.flatnonzero(is_rival)), key=lambda k: -score[k])]
    chosen: dict[bytes, int] = {}
    for k, signature in zip(ranked, numbers.signatures(ranked), strict=True):
        chosen.setdefault(signature, k)
    rows = np.array([index for index, *_ in votes])

    def of_formulas(flags: Votes) -> frozenset[int]:
        return frozenset(map(int, rows[flags]))

    is_full = {*map(int, rows), *(index for index, _ in trivial)} == {*range(len(formulas))}
    return [
        Match(
            tried[k], float(holding[k]), len(votes), of_formulas(~agreeing[:, k]),
            bool(is_nearly[k]), of_formulas(unexplained[:, k]), signature,
            sum(row in tried[k].stating for row in rows), is_full,
        )
        for signature, k in [*chosen.items()][:MAX_RIVALS]
    ]  # fmt: skip


def _comparisons(
    numbers: Numbers, formula: DocumentFormula, rest: DocumentFormula, lacking: Votes
) -> Iterator[tuple[str, Votes]]:
    """Yield the comparisons of a formula; for some candidates those of what is left of it."""
    others = iter(() if rest is formula else numbers.comparisons(rest))
    for side, vote in numbers.comparisons(formula):
        _, other = next(others, (side, vote))
        yield side, np.where(lacking, other, vote)


def _linearised(formulas: Sequence[DocumentFormula]) -> set[int]:
    """The numbers of linear equations of motion behind an approximation.

    They have no function of an angle of which others have a sine or cosine.
    """
    angles = {stem(one[1]) for formula in formulas for one in OF_ANGLE.finditer(formula.text)}
    near = [k for k, one in enumerate(formulas) if not {*one.relations}.isdisjoint(NEAR)]
    if not angles or not near:
        return set()
    return {
        k
        for k, one in enumerate(formulas)
        if k > near[0]
        and 2 in map(order, one.words)
        and angles & {*map(stem, one.words)}
        and not OF_ANGLE.search(one.text)
    }


def _of_special_motions(
    tried: Sequence[SystemCandidate], letters: Letters, formulas: Sequence[DocumentFormula]
) -> set[int]:
    """The numbers of formulas of special motions, which stated systems do not determine.

    They contain coordinates or momenta without rates, and letters that neither energies contain
    nor equations nor positions.
    """
    if tried[0].basis not in ("energies", "equations"):
        return set()
    known = frozenset[str]().union(*(one.letters for one in tried))
    known |= {*filter(POINT.match, letters.parameters)}
    other, count = {*letters.parameters} - known, -1
    moving = {*letters.coordinates, *letters.momenta}
    while count < len(other):  # also letters that these define
        count = len(other)
        defined = (one.subject for one in formulas if not other.isdisjoint(one.words))
        other |= {name for name in defined if name and not order(name)}
        other -= {*moving, *letters.quantities, *known}
    return {
        number
        for number, one in enumerate(formulas)
        if not (other.isdisjoint(one.words) or moving.isdisjoint(one.words))
        and one.subject not in letters.quantities
        and not any(map(order, one.words))
    }


def _is_equation(formula: DocumentFormula) -> bool:
    """Whether a formula is an equation of motion."""
    return len(formula.sides) == 2 and any(order(word) == 2 for word in formula.words)


def _without_loads(
    tried: Sequence[SystemCandidate], loads: set[str], formula: DocumentFormula
) -> tuple[DocumentFormula, Votes]:
    """An equation of motion without the forces of which energies of a document state nothing.

    With it, the candidates of stated energies without these letters.
    """
    own = loads & {*formula.words}
    if own and _is_equation(formula) and tried[0].basis == "energies":
        rest = without_unknown_terms(formula, own)
        if rest is not None:
            return rest, np.array([own.isdisjoint(one.letters) for one in tried])
    return formula, np.zeros(len(tried), bool)


def _uses_letters(tried: Sequence[SystemCandidate], written: frozenset[str]) -> NDArray[np.bool_]:
    """For each candidate, whether the parameters in a formula have a meaning with it."""
    # many candidates share their parameters
    shared = {id(one.parameters): one.parameters for one in tried}
    others = {key: written - {*own.values()} for key, own in shared.items()}
    rests = (others[id(one.parameters)] for one in tried)
    return np.array(
        [not rest or rest <= one.letters for rest, one in zip(rests, tried, strict=True)]
    )
