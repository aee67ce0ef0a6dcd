"""Frequencies and periods of small motions that a document states by parameters alone."""

import re
from collections.abc import Callable

import sympy as sp

from derive.verification.documents.rules.known_values import DocumentNamespace
from derive.verification.documents.rules.roles import Roles
from derive.verification.documents.rules.side_verdict import SideVerdict, plain
from derive.verification.documents.rules.small_motions import MAX_INVERSE, SmallMotions
from derive.verification.documents.statements import DocumentFormula
from derive.verification.documents.text import FormulaText

#: Letters of angular frequencies, frequencies and periods, with the angular frequency of each.
KINDS: dict[str, Callable[[sp.Expr], sp.Expr]] = {
    **dict.fromkeys(("omega", "Omega", "w"), lambda value: value),
    **dict.fromkeys(("f", "nu"), lambda value: 2 * sp.pi * value),
    **dict.fromkeys(("T", "P", "tau"), lambda value: 2 * sp.pi / value),
}
#: Words of sentences about them.
ABOUT = re.compile(
    "fre[qc]uen|fréquen|frequenz|pulsa|p[eé]riod|oscill|schwing|eigen|harmoni|natural|周期|频率"
    "|頻率|振動数",
    re.IGNORECASE,
)
NOTE = "it is that of small motions"


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
        is_named = letter in KINDS and not isinstance(value, sp.MatrixBase)
        has_place = 0 < len(system.q) <= MAX_INVERSE and not system.constraints
        if not is_named or not has_place or self._linear.place is None:
            return None
        if value == 0 or not value.free_symbols <= {*system.params}:
            return None
        M, D, K, _ = self._linear.matrices
        square = KINDS[letter](value ** sp.Rational(1, power)) ** 2
        is_zero = self._namespace.model.context.is_zero
        if is_zero((K - square * M).det()):
            return plain("verified", formula, NOTE)
        if len(system.q) > 1:
            return None
        required = K[0] / M[0]
        if is_zero(square - required + (D[0] / M[0]) ** 2 / 4):
            return plain("verified", formula, f"{NOTE} with friction")
        is_about = index in ("", "0", "n") and ABOUT.search(formula.occurrence.prose)
        if not is_about or not self._is_only_one(required) or any(D):
            return None
        if sp.cancel(square).free_symbols != sp.cancel(required).free_symbols:
            return None  # that of another motion
        root = sp.sqrt(required)
        correct = {"f": root / (2 * sp.pi), "T": 2 * sp.pi / root}
        kind = {"nu": "f", "P": "T", "tau": "T"}.get(letter, letter)
        result = self._roles.value(side, name, correct.get(kind, root) ** power)
        return result if result.verdict.verdict == "wrong" else None

    def _is_only_one(self, square: sp.Expr) -> bool:
        """Whether motions about the origin are stable, and forces have no other equilibrium.

        These are forces that depend on the coordinate alone but for a factor, as g sin(θ)/l does.
        """
        (q,), d = self._namespace.derivation.system.q, self._namespace.derivation
        potential = d.potential_energy.diff(q)
        force = sp.simplify(potential / potential.diff(q).subs(q, 0)) if potential else sp.S.Zero
        is_known = force in (q, sp.sin(q)) and not d.kinetic_energy.xreplace(
            dict.fromkeys(d.system.qdot, sp.S.Zero)
        )
        return self._linear.is_origin and is_known and not square.could_extract_minus_sign()
