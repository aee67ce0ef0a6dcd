"""Names and units in figures."""

GREEK = (
    "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi chi "
    "psi omega Gamma Delta Theta Lambda Pi Sigma Phi Psi Omega"
).split()


#: The letters, and the digits of indices.
LETTERS = dict(zip(GREEK, "αβγδεζηθκλμνξπρστφχψωΓΔΘΛΠΣΦΨΩ", strict=True))
INDICES = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def plain_symbol(name: str) -> str:
    """A name of a coordinate or parameter in Unicode: ``θ₁`` for ``theta1``."""
    stem, _, below = name.partition("_")
    letters = stem.rstrip("0123456789")
    index = stem[len(letters) :].translate(INDICES)
    return LETTERS.get(letters, letters) + index + (f"_{below}" if below else "")


def symbol(name: str) -> str:
    r"""A name in mathematical notation.

    Parameters
    ----------
    name : str
        Name of a coordinate, velocity or parameter: a letter and an index, with ``_dot`` after
        them for a velocity.

    Returns
    -------
    str
        TeX between dollar signs: ``$\dot{\theta}_{1}$`` for ``theta1_dot``.
    """
    return f"${_tex(name)}$"


def _tex(name: str) -> str:
    base, dot, _ = name.partition("_dot")
    stem, _, below = base.partition("_")
    letters = stem.rstrip("0123456789")
    index = stem[len(letters) :] + (_tex(below) if below else "")
    word = rf"\{letters}" if letters in GREEK else letters
    word = rf"\dot{{{word}}}" if dot else word
    return f"{word}_{{{index}}}" if index else word


def axis_label(words: str, unit: str) -> str:
    """A quantity divided by its unit, as axes are labelled; without the unit 1."""
    if unit in ("", "1"):
        return words
    return f"{words} / {f'({unit})' if '/' in unit else unit}"
