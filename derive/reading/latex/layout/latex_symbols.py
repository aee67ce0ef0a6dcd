"""Commands of LaTeX and characters of Unicode by their meaning in a formula."""

#: Letters that mean a difference or a variation of the letter behind them.
VARIATIONS = ("Delta", "delta")
GREEK = frozenset(
    """alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi
    omicron rho varrho sigma varsigma tau upsilon phi varphi chi psi omega Gamma Delta Theta Lambda
    Xi Pi Sigma Upsilon Phi Psi Omega""".split()
)
#: Further letters; pi is a number in the argument of a function, as in ``\sin\pi x``.
LETTERS = frozenset("pi ell hbar imath jmath infty partial star circ dagger varpi emptyset".split())
ELLIPSES = frozenset("dots ldots cdots vdots ddots dotsc dotsb dotsm".split())

FUNCTIONS = {
    **{name: name for name in "sin cos tan cot sec csc sinh cosh tanh coth exp log det".split()},
    **{f"arc{name}": f"a{name}" for name in "sin cos tan cot sinh cosh tanh".split()},
    **{f"ar{name}": f"a{name}" for name in "sinh cosh tanh".split()},
    **{name: name for name in "asin acos atan atan2 asinh acosh atanh".split()},
    **{f"{arc}{name}": f"{arc[:1]}{other}" for arc in ("", "arc")
       for name, other in (("sen", "sin"), ("senh", "sinh"), ("tg", "tan"), ("ctg", "cot"))},
    "ln": "log", "sgn": "sign", "sign": "sign", "cosec": "csc", "arctan2": "atan2",
    "max": "max", "Max": "max", "min": "min", "Min": "min",
}  # fmt: skip
#: Functions that have an inverse, which the exponent -1 denotes.
INVERTIBLE = frozenset("sin cos tan cot sinh cosh tanh".split())

RELATIONS = {
    "=": "=", ":=": ":=", "=:": "=", ":": ":", "<": "<", ">": ">",
    "equiv": "=", "coloneqq": ":=", "coloneq": ":=", "triangleq": ":=", "doteq": "~", "colon": ":",
    "approx": "~", "simeq": "~", "sim": "~", "cong": "~", "approxeq": "~",
    "leq": "<=", "le": "<=", "leqslant": "<=", "geq": ">=", "ge": ">=", "geqslant": ">=",
    "lt": "<", "gt": ">", "ll": "<", "gg": ">",
    "neq": "!=", "ne": "!=", "to": "->", "rightarrow": "->", "longrightarrow": "->", "in": "in",
}  # fmt: skip
#: Commands between two statements.
SEPARATORS = frozenset(
    """implies Rightarrow Longrightarrow impliedby Leftarrow Longleftarrow iff Leftrightarrow
    Longleftrightarrow therefore because land lor wedge forall leadsto rightsquigarrow""".split()
)
TIMES = frozenset("* cdot times ast cdotp".split())
SLASHES = frozenset("/ div".split())

ACCENTS = {"dot": 1, "ddot": 2, "dddot": 3, "ddddot": 4}
#: Marks over a letter, which become part of its name.
MARKS = {
    "bar": "bar", "overline": "bar", "hat": "hat", "widehat": "hat", "tilde": "tilde",
    "widetilde": "tilde", "check": "check", "breve": "breve", "mathring": "ring",
    "underline": "under",
}  # fmt: skip
BOLD = frozenset("mathbf boldsymbol bold bm pmb mathbfit symbf vec overrightarrow".split())
UPRIGHT = frozenset("mathrm operatorname mathsf mathtt mathup".split())
SCRIPT = frozenset("mathcal mathscr mathfrak mathbb mathit mathnormal".split())
FONTS = BOLD | UPRIGHT | SCRIPT
FRACTIONS = frozenset("frac tfrac dfrac cfrac nicefrac sfrac flatfrac".split())
TEXT = frozenset("text textrm textit textbf textsf textnormal mbox hbox textup".split())

#: Commands without a meaning, by their number of arguments.
LAYOUT = {
    **dict.fromkeys(
        """nonumber notag displaystyle textstyle scriptstyle scriptscriptstyle limits nolimits
        allowbreak nobreak noindent strut mathstrut hfill hfil hline centering relax middle protect
        normalsize small footnotesize scriptsize large Large break nobreakspace null
        boxed fbox cancel bcancel xcancel mathop mathrel mathbin mathord mathopen mathclose
        mathinner ensuremath smash mathpunct qedhere qed checkmark square blacksquare""".split(),
        0,
    ),
    **dict.fromkeys(
        """label tag vspace phantom hphantom vphantom color cite ref eqref cref require textcolor
        colorbox class cssId style href""".split(),
        1,
    ),
    "definecolor": 3, "rule": 2,
}  # fmt: skip
#: Commands that frame, strike or colour the argument behind them.
FRAMES = frozenset("boxed fbox cancel bcancel xcancel textcolor colorbox mathop smash href".split())
SPACES = frozenset(", ; : ! > ~ / thinspace medspace thickspace negthinspace enspace space".split())
GAPS = frozenset("quad qquad enskip".split())

BRACKETS = {
    "(": ("open", "("), ")": ("close", "("), "[": ("open", "["), "]": ("close", "["),
    "\\{": ("open", "{"), "\\}": ("close", "{"), "\\lbrace": ("open", "{"),
    "\\rbrace": ("close", "{"), "\\lbrack": ("open", "["), "\\rbrack": ("close", "["),
    "\\lvert": ("open", "|"), "\\rvert": ("close", "|"), "\\lVert": ("open", "|"),
    "\\rVert": ("close", "|"), "\\langle": ("open", "<"), "\\rangle": ("close", "<"),
    "\\lfloor": ("open", "floor"), "\\rfloor": ("close", "floor"),
    "|": ("bar", "|"), "\\|": ("bar", "|"), "\\vert": ("bar", "|"), "\\Vert": ("bar", "|"),
}  # fmt: skip

MATRICES = frozenset(
    """matrix pmatrix bmatrix Bmatrix vmatrix Vmatrix smallmatrix psmallmatrix bsmallmatrix array
    """.split()
)
#: Environments whose rows are statements or parts of them.
ROWS = frozenset(
    """equation align aligned alignat alignedat flalign gather gathered multline multlined split
    eqnarray displaymath math dmath subequations empheq IEEEeqnarray cases dcases""".split()
)

#: Words between two statements.
CONNECTIVES = frozenset(
    """and or where with for if when whenever so thus hence then therefore since because as while
    which gives but i.e. e.g. und oder mit wobei falls et ou avec""".split()
)

#: Combining characters of Unicode and the accents that they are.
COMBINING = {
    "\u0307": "dot", "\u0308": "ddot", "\u20db": "dddot", "\u20dc": "ddddot", "\u0304": "bar",
    "\u0305": "bar", "\u0302": "hat", "\u0303": "tilde", "\u20d7": "vec", "\u030a": "mathring",
}  # fmt: skip
#: Characters of Unicode as LaTeX.
CHARACTERS = {
    "·": r"\cdot", "⋅": r"\cdot", "∙": r"\cdot", "×": r"\times", "−": "-", "–": "-", "∗": "*",
    "÷": r"\div", "∕": "/", "⁄": "/", "√": r"\sqrt", "∂": r"\partial", "∇": r"\nabla",
    "∑": r"\sum", "∞": r"\infty", "≈": r"\approx", "≃": r"\simeq", "≅": r"\cong",
    "≡": r"\equiv", "≤": r"\leq", "≥": r"\geq", "≠": r"\neq", "≔": r"\coloneqq", "→": r"\to",
    "⇒": r"\Rightarrow", "⟹": r"\implies", "⇔": r"\iff", "∴": r"\therefore", "∵": r"\because",
    "∈": r"\in", "±": r"\pm", "∓": r"\mp", "∫": r"\int", "…": r"\dots", "⋯": r"\cdots",
    "′": "'", "’": "'", "″": "''", "‴": "'''", "ℓ": r"\ell", "ℒ": "L", "ℋ": "H", "ϕ": r"\phi",
    "ϑ": r"\vartheta", "ϵ": r"\epsilon", "ϱ": r"\varrho", "ς": r"\varsigma", "µ": r"\mu",
    "⊤": r"\top", "°": r"^{\circ}",
    "‖": r"\|", "∥": r"\|", "⟨": r"\langle", "⟩": r"\rangle",
    "\u00a0": " ", "\u2009": " ", "\u202f": " ", "\u2003": r"\quad",
    "\u200a": " ", "\u2002": " ", "\u2062": " ",
    **dict(zip("αβγδεζηθικλμνξοπρστυφχψω", (
        rf"\{name}" for name in
        """alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho
        sigma tau upsilon phi chi psi omega""".split()
    ), strict=True)),
    **dict(zip("ΓΔΘΛΞΠΣΥΦΨΩ", (
        rf"\{name}" for name in
        "Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega".split()
    ), strict=True)),
}  # fmt: skip
