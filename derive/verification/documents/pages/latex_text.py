"""Text and formulas of any origin as LaTeX that compiles."""

import re
from collections.abc import Collection, Mapping, Sequence
from string import ascii_letters
from unicodedata import normalize

from derive.formulas.typeset.lettering import GREEK
from derive.reading.latex.display_reader import Macro, formulas
from derive.reading.latex.layout.plain_words import WORD
from derive.reading.latex.layout.tokens import script_of
from derive.reading.latex.tree import Statement
from derive.verification.documents.pages.verdicts_in_place import one_line

SPECIAL = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "$": r"\$",
    "&": r"\&",
    "#": r"\#",
    "%": r"\%",
    "_": r"\_",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': "''",
    "−": r"\ensuremath{-}",
    "·": r"\ensuremath{\cdot}",
    "≈": r"\ensuremath{\approx}",
    "≠": r"\ensuremath{\neq}",
    "≤": r"\ensuremath{\leq}",
    "≥": r"\ensuremath{\geq}",
    "∂": r"\ensuremath{\partial}",
    "…": r"\ldots{}",
    "–": "--",
    "“": "``",
    "”": "''",
    "’": "'",
}
GREEK_NAMES = {letter: name for name, letter in GREEK.items()}
GREEK_LETTER = re.compile(r"\\ensuremath\{(\\[A-Za-z]+)\}")
#: Accents that follow their letter in Unicode, in text and in formulas.
ACCENTS = {
    "\u0300": (r"\`", r"\grave"),
    "\u0301": (r"\'", r"\acute"),
    "\u0302": (r"\^", r"\hat"),
    "\u0303": (r"\~", r"\tilde"),
    "\u0304": (r"\=", r"\bar"),
    "\u0307": (r"\.", r"\dot"),
    "\u0308": (r"\"", r"\ddot"),
    "\u030c": (r"\v", r"\check"),
    "\u0327": (r"\c", r""),
}
#: Commands with arguments, with a delimiter behind them, and others.
TAKING = frozenset(
    """frac dfrac tfrac cfrac binom sqrt dot ddot dddot ddddot bar hat tilde vec check breve
    mathring overline underline widehat widetilde overrightarrow mathrm mathbf mathit mathsf mathtt
    mathcal mathnormal boldsymbol operatorname text textrm textit textbf mbox boxed phantom hphantom
    vphantom""".split()
)
SIZED = frozenset(f"{size}{side}" for size in "big Big bigg Bigg".split() for side in ("", *"lr"))
COMMANDS = (
    TAKING
    | SIZED
    | frozenset(
        """alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu
        xi pi varpi rho varrho sigma varsigma tau upsilon phi varphi chi psi omega Gamma Delta Theta
        Lambda Xi Pi Sigma Upsilon Phi Psi Omega ell hbar imath jmath infty partial nabla star circ
        dagger prime top bot forall in
        sin cos tan cot sec csc sinh cosh tanh coth arcsin arccos arctan exp log ln det lim min max
        sum prod int iint oint cdot times ast pm mp div
        left right middle langle rangle lvert rvert lVert rVert vert Vert lbrace rbrace lbrack
        rbrack lfloor rfloor
        leq geq le ge neq ne equiv approx sim simeq cong propto ll gg to rightarrow Rightarrow
        implies iff Leftrightarrow longrightarrow mapsto quad qquad dots ldots cdots vdots ddots
        colon displaystyle textstyle begin end""".split()
    )
)
#: An argument without braces that takes arguments itself, no argument, no delimiter.
UNSAFE = re.compile(
    rf"\\(?:{'|'.join(TAKING)}|[dtc]?frac\s*\w)\s*\\(?:{'|'.join(TAKING)}|left)(?![A-Za-z])|"
    rf"(?:\\(?:{'|'.join(TAKING)})|[_^])\s*(?:[&'}}]|\\\\|$)|"
    rf"\\(?:{'|'.join(SIZED)})(?![A-Za-z])(?!\s*(?:[()\[\]|./]|\\[{{}}|]|\\[lr](?:vert|Vert|angle)))"
)
ENVIRONMENTS = frozenset(
    "matrix pmatrix bmatrix Bmatrix vmatrix Vmatrix smallmatrix array cases aligned split gathered "
    "alignedat".split()
)
#: What is numbered or commented in the document is not in a note.
DROPPED = re.compile(r"\\(?:label|tag)\*?\s*\{[^{}]*\}|\\(?:nonumber|notag)\b|(?<!\\)%[^\n]*")
TOKEN = re.compile(r"\\(begin|end)\s*\{([^{}]*)\}|\\([A-Za-z]+)|\\(.)|([{}])|([^\\{}])", re.S)
SYMBOLS = frozenset(" ,;:!{}|\\")
#: Characters of a formula on its own.
PLAIN = frozenset(ascii_letters + "0123456789+-*/=<>()[]|.,;:!'^_& ?")


def escaped(text: str) -> str:
    """Text in which no character has a meaning of its own in LaTeX."""
    pieces: list[str] = []
    for one in normalize("NFD", text):
        if one in ACCENTS and pieces:
            in_text, in_formula = ACCENTS[one]
            letter = GREEK_LETTER.fullmatch(pieces[-1])
            pieces[-1] = (
                rf"\ensuremath{{{in_formula}{{{letter[1]}}}}}"
                if letter
                else f"{in_text}{{{pieces[-1]}}}"
            )
        else:
            pieces.append(SPECIAL.get(one) or _character(one))
    return "".join(pieces)


def _character(one: str) -> str:
    if one.isascii():
        return one if one.isprintable() else " "
    if one in GREEK_NAMES:
        return rf"\ensuremath{{\{GREEK_NAMES[one]}}}"
    plain = "".join(c for c in normalize("NFKD", one).replace("⁄", "/") if c.isascii())
    if sign := script_of(one):
        return rf"\ensuremath{{{{}}{sign}{{{plain}}}}}"
    return "".join(SPECIAL.get(c, c) for c in plain) or "?"


def code(text: str) -> str:
    """Source text in a line of text."""
    return rf"\texttt{{{escaped(one_line(text))}}}" if text else ""


def formula(latex: str, macros: Mapping[str, Macro] = {}) -> str:
    """A formula in a line of text, or its source where LaTeX may refuse it.

    Parameters
    ----------
    latex
        The formula, of any origin.
    macros
        Macros that the document defines.
    """
    kept = one_line(DROPPED.sub(" ", latex))
    if not kept:
        return ""
    readable = all(isinstance(one, Statement) for one in formulas(kept, macros))
    if not (readable and _is_known(kept, macros)) or WORD.search(re.sub(r"\\[A-Za-z]+", "", kept)):
        return code(kept)
    if re.search(r"&|\\\\", kept):
        return rf"$\displaystyle\begin{{aligned}}{kept}\end{{aligned}}$"
    return rf"$\displaystyle {kept}$"


def _is_known(latex: str, macros: Collection[str]) -> bool:
    """Whether all commands and characters of a formula are known, and its brackets are closed."""
    tokens = [result.groups() for result in TOKEN.finditer(latex)]
    return (
        all(one in COMMANDS or one in macros for _, _, one, *_ in tokens if one)
        and all(one in SYMBOLS for *_, one, _, _ in tokens if one)
        and all(one in PLAIN for *_, one in tokens if one)
        and _is_closed(tokens)
        and not UNSAFE.search(latex)
        and not latex.endswith("\\")
    )


def _is_closed(tokens: Sequence[tuple[str | None, ...]]) -> bool:
    """Whether braces, environments and brackets that grow are closed in the right order."""
    expected: list[str] = []
    for environment, which, command, symbol, brace, character in tokens:
        if expected[-1:] == ["}"] and (symbol == "\\" or character == "&"):
            return False  # a cell or a row ends within braces
        if environment == "begin" and which in ENVIRONMENTS:
            expected.append(f"end {which}")
        elif command == "left":
            expected.append("right")
        elif brace == "{":
            expected.append("}")
        elif environment or command == "right" or brace:
            closed = f"end {which}" if environment else command or brace
            if not expected or expected.pop() != closed:
                return False
    return not expected
