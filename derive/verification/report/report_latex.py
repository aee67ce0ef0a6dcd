r"""The report's LaTeX in the syntax of formulas.

Its letters have the names of the project: an index that is a number follows its letter directly,
as in ``theta1_dot`` of ``\dot{\theta}_1``, both l and ℓ are ``l``, and i + 1 is ``next``.
"""

import json
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from derive.reading.latex.display_reader import Macro, formulas
from derive.reading.latex.tree import Letter, Statement, Unreadable
from derive.verification.documents.formula_translation import FormulaTranslator, LetterNotation

#: Quantities that are printed with the arguments on which alone they depend, as in α_1(φ_1, φ_2).
DEPENDENT = [f"{letter}_{index}" for letter in ("alpha", "f", "g") for index in "12i"]
#: Letters before brackets: θ(t) is a function whose argument does not matter, f(t, w) is a value
#: for these arguments, and l(sin θ, cos θ, 0) is a product with a column.
NOTATION = LetterNotation(
    functions=frozenset({"theta"}),
    calls=frozenset({"f", "y", *DEPENDENT}),
    factors=frozenset({"l", "l_1", "l_2"}),
    matrices=frozenset({"A", "B"}),
)
#: Translations of the report's equations by their LaTeX, so that no LaTeX is parsed for them.
STORED = Path(__file__).with_name("translations.json")
WORD = re.compile(r"[A-Za-z_]\w*")
CALL = re.compile(rf"\b({'|'.join(DEPENDENT)})\(")


def statements(latex: str, macros: Mapping[str, Macro] = {}) -> list[Statement | Unreadable]:
    """The statements of a display without remarks, such as "for i = 1, 2" or "for real x"."""
    result = formulas(latex, macros)
    judged = [one for one in result if isinstance(one, Unreadable) or _is_equation(one)]
    return judged or result


def _is_equation(statement: Statement) -> bool:
    first = statement.sides[0]
    is_index = isinstance(first, Letter) and first.identifier == "i"
    return bool(statement.relations) and not is_index


def text(statement: Statement) -> str:
    """A statement in the syntax of formulas; a colon is an equals sign."""
    translator = FormulaTranslator(NOTATION)
    sides = [translator.text(side).text for side in statement.sides]
    relations = [relation.replace(":", "=").replace("==", "=") for relation in statement.relations]
    pieces = [piece for pair in zip(relations, sides[1:], strict=True) for piece in pair]

    def name(match: re.Match[str]) -> str:
        if match[0] in translator.derivatives:
            function, variables = translator.derivatives[match[0]]
            return f"d({function}, {', '.join(map(_name, variables))})"
        return _name(match[0])

    joined = " ".join([sides[0], *pieces])
    return WORD.sub(name, CALL.sub(r"only(\1, ", joined))


def _name(word: str) -> str:
    word = re.sub(r"^ell(?=_|$)", "l", word).replace("_i_plus_1", "_next")
    return re.sub(r"_(?=\d)", "", word)


def translation(latex: str) -> str:
    """The statements of a display, separated by semicolons; unreadable LaTeX stays as it is."""
    return _stored().get(latex) or read(latex)


@cache
def _stored() -> dict[str, str]:
    translations: dict[str, str] = json.loads(STORED.read_text(encoding="utf-8"))
    return translations


def read(latex: str) -> str:
    """The same, read from the LaTeX."""
    result = statements(latex)
    readable = [one for one in result if isinstance(one, Statement)]
    return "; ".join(map(text, readable)) if len(readable) == len(result) else latex
