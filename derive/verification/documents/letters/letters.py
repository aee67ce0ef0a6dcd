"""The letters of a document: which of them move, and what the others are by their names.

Names of letters only order the possibilities, except for energies and momenta, which are named
alike everywhere.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import Any, Self

import sympy as sp

from derive.verification.documents.formula_translation import order
from derive.verification.documents.jets import FUNCTIONS
from derive.verification.documents.letters.stated_constraints import StatedConstraint
from derive.verification.documents.statements import ENTRY, WORD, DocumentFormula

#: Names of energies and of the Lagrangian, without their index.
QUANTITIES: dict[str, str] = {
    "L": "lagrangian",
    **dict.fromkeys(("T", "K", "KE", "EK", "Ek"), "kinetic_energy"),
    **dict.fromkeys(("V", "U", "PE", "EP", "Ep"), "potential_energy"),
    "H": "hamiltonian",
    "E": "energy",
}
#: Indices that make an energy of E.
ENERGIES = {
    **dict.fromkeys(("k", "kin", "K", "c"), "kinetic_energy"),
    **dict.fromkeys(("p", "pot", "P"), "potential_energy"),
    **dict.fromkeys(("tot", "total", "t", "mech"), "energy"),
}
#: Kinds of partial energies by the first letter of their index, such as that of E_k1.
KINDS_OF_ENERGIES = {"k": "kinetic_energy", "p": "potential_energy"}
#: Most letters that can be a coordinate of one kind.
MAX_COORDINATES = 6
#: Names of the mass matrix M of M q̈ + C q̇ = G, of the matrix C and of the column G.
MATRICES = {"M": "mass_matrix", "C": "coriolis_matrix", "G": "gravity", "g": "gravity"}
#: Numbers of entries of matrices and columns.
SQUARES, COLUMNS = (4, 9, 16, 25), (2, 3, 4, 5)
#: Indices that change nothing.
TOTAL = ("", "tot", "total", "sys", "kin", "pot")

#: Kinds of parameters by the first letters of their names, the usual ones first.
KINDS: dict[str, tuple[str, ...]] = {
    "mass": ("m", "M", "mu", "mass"),
    "length": ("l", "L", "ell", "r", "R", "a", "b", "d", "h", "s", "rho", "length", "A"),
    "gravity": ("g", "G"),
    "stiffness": ("k", "K", "kappa", "c"),
    "inertia": ("I", "J", "Theta"),
    "frequency": ("omega", "Omega", "w", "nu"),
    "damping": ("b", "c", "d", "gamma", "beta", "mu", "nu", "delta", "B", "eta", "h", "Kd", "kd"),
    "force": ("F", "u", "f", "tau", "Q", "U", "T"),
}

#: Parts of longer names, as programs have them.
PARTS: dict[str, tuple[str, ...]] = {
    "mass": ("mass",),
    "length": ("length",),
    "gravity": ("grav",),
    "stiffness": ("stiff", "spring"),
    "inertia": ("inertia",),
    "frequency": ("omega", "freq"),
    "damping": ("damp", "fric", "gam"),
    "force": ("force", "torque", "action"),
}

#: Letters that programs write with an index in one word, by the kind of the parameter.
WITH_INDEX = {
    "mass": "mM", "length": "lLrR", "inertia": "IJ", "stiffness": "kK", "damping": "bB",
    "frequency": "w",
}  # fmt: skip
#: A letter with a word as its index, such as mCart.
CAPITAL = re.compile(r"[A-Za-z][A-Z][a-z]+\Z")

OPERATORS = {*FUNCTIONS, "ddt", "diff", "inverse", "transpose", "square", "norm", "cross", "pi"}
OPERATORS |= {"det", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "sign", "max", "min"}
#: Abbreviations of sines and cosines, such as s_1, c_12 and s_1_plus_2.
ABBREVIATION = re.compile(r"([sc])_(\d(?:_plus_\d|\d)*)\Z")
#: A column of names.
COLUMN = re.compile(r"\((\w+(?:, \w+)+)\)")
GENERIC = re.compile(r"\w+_[ij]\Z")
#: The derivative of a name.
DERIVATIVE = re.compile(r"\b(?:ddt|diff)\(\w+(?:, \w+)*\)")


#: Names of angles and of other coordinates by their first letters.
ANGLES = ("theta", "phi", "varphi", "alpha", "beta", "psi", "vartheta", "gamma", "q")


@dataclass(frozen=True)
class Letters:
    """The names of a document without dots."""

    coordinates: tuple[str, ...]  # the likeliest first
    momenta: Mapping[str, str]  # and their coordinates
    quantities: Mapping[str, str]  # and their kinds
    parameters: tuple[str, ...]  # all others that no formula defines
    accelerated: tuple[str, ...]  # coordinates whose accelerations occur, and no definition
    abbreviations: Mapping[str, tuple[str, tuple[str, ...]]]  # such as s_12: sine of q_1 and q_2
    ordered: tuple[str, ...]  # coordinates in the order of columns and matrices
    other_orders: tuple[tuple[str, ...], ...] = ()  # if the document does not state it
    kinds: Mapping[str, str] = field(default_factory=dict)  # of parameters, if they are given
    multipliers: tuple[str, ...] = ()  # parameters that can be multipliers of constraints
    constraints: tuple[StatedConstraint, ...] = ()
    elsewhere: frozenset[str] = frozenset()  # coordinates of other systems of the document
    are_of_program: bool = False  # which states accelerations alone
    turning: frozenset[str] = frozenset()  # coordinates that only functions of angles contain

    @property
    def column(self) -> str:
        """The name q of the column of coordinates q_1, q_2 ..., or "" of others."""
        names = {name.partition("_")[0] for name in self.ordered}
        name = names.pop() if len(names) == 1 else ""
        numbered = [f"{name}_{k + 1}" for k in range(len(self.ordered))]
        return name if [*self.ordered] == numbered and name not in self.parameters else ""

    def reused(self, formula: DocumentFormula) -> str:
        """A letter of an energy among accelerations, where it is another quantity.

        Such as a tension T; empty if there is none.
        """
        names = WORD.findall(DERIVATIVE.sub("", formula.text))
        if not any(order(name) == 2 for name in names):
            return ""
        energies = {name for name, kind in self.quantities.items() if kind not in MATRICES.values()}
        return next((name for name in names if name in energies - {formula.subject}), "")

    def hinted(self, kinds: Mapping[str, str]) -> Self:
        """The letters with given kinds of parameters."""
        return replace(self, kinds=kinds)

    def orders(self, are_angles: Sequence[bool]) -> Iterator[tuple[str, ...]]:
        """Yield coordinates for those of a system, of which some are angles.

        Greek letters are angles, also what only functions of angles contain, and others are not,
        unless there are too few of these.
        """
        angles = [q for q in self.coordinates if q.partition("_")[0] in ANGLES or q in self.turning]
        lengths = [q for q in self.coordinates if q not in angles or q.partition("_")[0] == "q"]
        pools = {
            True: angles if len(angles) >= are_angles.count(True) else self.coordinates,
            False: lengths if len(lengths) >= are_angles.count(False) else self.coordinates,
        }
        pools = {is_angle: pool[:MAX_COORDINATES] for is_angle, pool in pools.items()}
        for choice in product(*(pools[is_angle] for is_angle in are_angles)):
            if len(set(choice)) == len(choice):
                yield choice

    def of_kind(self, kind: str) -> list[str]:
        """Parameters that can be of a kind, the usual ones first."""
        return self._by_kind[kind]

    @cached_property
    def _by_kind(self) -> Mapping[str, list[str]]:
        return {kind: self._of_kind(kind) for kind in KINDS}

    def _of_kind(self, kind: str) -> list[str]:
        usual = KINDS[kind]
        given = [name for name, own in self.kinds.items() if own == kind]
        stems = {p: p.partition("_")[0].rstrip("0123456789") for p in self.parameters}
        named = [p for p in self.parameters if stems[p] in usual and p not in self.kinds]
        parts = PARTS.get(kind, ())
        worded = [
            p
            for p in self.parameters
            if any(one in p.lower() for one in parts) or _has_index(stems[p], kind)
        ]
        worded = [p for p in worded if p not in (*named, *self.kinds)]
        return [*given, *sorted(named, key=lambda p: (usual.index(stems[p]), p)), *worded]


def _has_index(stem: str, kind: str) -> bool:
    """Whether a name is a letter of a kind with an index, such as mp, Jr and mCart."""
    is_indexed = len(stem) == 2 or CAPITAL.match(stem) is not None
    return is_indexed and stem[0] in WITH_INDEX.get(kind, "") and stem not in KINDS["mass"]


def energy_of_part(name: str) -> str | None:
    """The energy of which a name denotes a part, such as T_1 and E_k1."""
    letter, _, index = name.partition("_")
    kind = KINDS_OF_ENERGIES.get(index[:1]) if letter == "E" else QUANTITIES.get(letter)
    is_part = kind in ("kinetic_energy", "potential_energy") and index not in TOTAL
    is_derivative = kind == "potential_energy" and name.endswith("_prime")
    return kind if is_part and not is_derivative else None


def matrices_by_entries(names: Iterable[str]) -> frozenset[str]:
    """Letters that have entries in two rows and columns."""
    result: dict[str, set[tuple[str, str]]] = {}
    for name in names:
        if (match := ENTRY.match(name)) and match[3]:
            result.setdefault(match[1], set()).add((match[2], match[3]))
    return frozenset(
        letter for letter, places in result.items() if {("1", "1"), ("2", "2")} <= places
    )


def composed(
    words: Iterable[str], namespace: Mapping[str, Any], count: int
) -> Iterator[tuple[str, sp.ImmutableDenseMatrix]]:
    """Yield the names of matrices and columns without a value whose entries have one."""
    matrices = matrices_by_entries(namespace)
    for name in words:
        letter = name.removesuffix("_column")
        if name in namespace or "_" in letter:
            continue
        if letter in matrices:
            yield name, _matrix(letter, namespace, count)
        elif name != letter:
            column = [namespace.get(f"{letter}_{k + 1}") for k in range(count)]
            if all(isinstance(one, sp.Expr) for one in column):
                yield name, sp.ImmutableDenseMatrix(column)


def _matrix(letter: str, namespace: Mapping[str, Any], count: int) -> sp.ImmutableDenseMatrix:
    """A matrix whose entries that are not written are those of its transpose, or zero."""

    def entry(i: int, j: int) -> sp.Expr:
        places = ((i + 1, j + 1), (j + 1, i + 1))
        names = [f"{letter}_{a}{between}{b}" for a, b in places for between in ("", "_")]
        return next((namespace[name] for name in names if name in namespace), sp.S.Zero)

    return sp.ImmutableDenseMatrix(count, count, entry)
