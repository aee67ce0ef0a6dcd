"""How pictures write names and units."""

from __future__ import annotations

GREEK = ("theta", "phi", "psi", "alpha", "beta")


def symbol(name: str) -> str:
    """A name as mathematics writes it."""
    base, dot, _ = name.partition("_dot")
    letters = base.rstrip("0123456789")
    index = base[len(letters) :]
    word = rf"\{letters}" if letters in GREEK else letters
    word = rf"\dot{{{word}}}" if dot else word
    return f"${word}_{{{index}}}$" if index else f"${word}$"


def divided(words: str, unit: str) -> str:
    """A quantity divided by its unit, which is a number."""
    return f"{words} / {f'({unit})' if '/' in unit else unit}"
