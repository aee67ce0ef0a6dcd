"""Wrong terms of formulas as the document writes them, and the formulas with correct ones."""

import ast
import re
from collections.abc import Mapping
from dataclasses import dataclass

from derive.formulas.syntax import is_sum, syntax_tree
from derive.formulas.typeset.latex import latex as latex_of
from derive.reading.latex.tree import Span
from derive.verification.documents.formula_translation import stem
from derive.verification.documents.letters.subjects import ARBITRARY
from derive.verification.documents.rules.side_verdict import SideVerdict
from derive.verification.documents.statements import DocumentFormula
from derive.verification.judging.verdict import Correction


@dataclass(frozen=True)
class Corrected:
    """LaTeX of the wrong terms and of the corrected formula, and the spans of the terms.

    A span is empty where a term is missing.
    """

    wrong_term: str = ""
    correction: str = ""
    spans: tuple[Span, ...] = ()


def corrected(
    formula: DocumentFormula, result: SideVerdict, letters: Mapping[str, str]
) -> Corrected:
    """The corrections of a verdict in LaTeX; empty if none are known."""
    latex, tree = formula.occurrence.latex, formula.occurrence.tree
    verdict, is_plain = result.verdict, formula.occurrence.is_plain
    is_subject = verdict.correction == formula.subject
    if not verdict.corrections and (is_subject or ARBITRARY in verdict.correction):
        return Corrected()  # nothing but the quantity itself, or letters of no document
    if not verdict.corrections or formula.index:
        whole = written(verdict.correction, letters, is_plain) if verdict.correction else ""
        if whole and result.kind != "euler_lagrange" and "=" not in whole:
            whole = f"{latex[slice(*formula.occurrence.sides[0].span)]} = {whole}"
        return Corrected(correction=whole)
    changes: list[tuple[Span, str]] = []
    for one in verdict.corrections:
        span = source_span(latex, result, one)
        if span is None:
            return Corrected(correction=written(verdict.correction, letters, is_plain))
        if not one.correct:
            return Corrected(latex[slice(*span)], "", (span,))
        new = written(one.correct, letters, is_plain)
        if one.wrong.startswith("-") and not latex[slice(*span)].startswith("-"):
            # the sign stands before a fraction, of which this is the numerator
            if is_sum(syntax_tree(one.correct)):
                new = f"-({new})" if is_plain else rf"-\left({new}\right)"
            else:
                new = new[1:] if new.startswith("-") else f"-{new}"
        if one.wrong:
            new = in_brackets(one, new, latex[: span[0]], latex[span[1] :], is_plain)
        changes.append((span, new))
    changes.sort(reverse=True)
    text, start = latex, tree.span[0]
    for (a, b), new in changes:
        text = inserted(text[:a], text[a:b], new, text[b:])
    end = tree.span[1] + len(text) - len(latex)
    spans = tuple(span for span, _ in reversed(changes))
    terms = [latex[slice(*span)] for span in spans if span[0] < span[1]]
    return Corrected("; ".join(terms), text[start:end].strip(), spans)


def source_span(source: str, result: SideVerdict, one: Correction) -> Span | None:
    """The span of a wrong term and its sign in the source; empty where a term is missing."""
    if not one.wrong:
        side = result.parts[0][1]
        whole = side.source(0, len(side.text))
        return whole and (whole[1], whole[1])
    start, end = one.span
    for offset, side in result.parts:
        if offset <= start and end <= offset + len(side.text):
            span = side.source(start - offset, end - offset)
            return _with_sign(source, span) if span and one.wrong[0] == "-" else span
    return None


def _with_sign(source: str, span: Span) -> Span:
    """The span with the minus sign before it."""
    start = len(source[: span[0]].rstrip())
    if source[start - 1 : start] == "-" and source[span[0]] != "-":
        return start - 1, span[1]
    return span


def inserted(before: str, old: str, new: str, after: str) -> str:
    """Put a term in place of another, and join its sign with the one before it."""
    head = before.rstrip()
    if not old:
        sign = " - " if new.startswith("-") else " + "
        return head + sign + new.lstrip("- ") + after
    if new.startswith("-") and head[-1:] in ("+", "-"):
        return f"{head[:-1]}{'-' if head[-1] == '+' else '+'} {new[1:].lstrip()}{after}"
    is_term = head[-1:] not in ("", *"=&({[+-,")
    if old.startswith("-") and new.startswith("-") and is_term:
        return f"{head} - {new[1:].lstrip()}{after}"
    if old.startswith("-") and not new.startswith("-") and is_term:
        return f"{before}+ {new}{after}"
    return before + new + after


def in_brackets(one: Correction, new: str, before: str, after: str, is_plain: bool = False) -> str:
    """A sum in brackets where it replaces a factor."""
    is_factor = before.rstrip()[-1:] not in ("", *"(+=&[{,") or after.lstrip()[:1] not in (
        "", *")+-=&]},\\",
    )  # fmt: skip
    if not is_factor or not is_sum(syntax_tree(one.correct)):
        return new
    return f"({new})" if is_plain else rf"\left({new}\right)"


def written(text: str, letters: Mapping[str, str], is_plain: bool = False) -> str:
    """A formula or an equation as LaTeX or in plain text, with the letters of a document."""
    write = _plain if is_plain else latex_of
    return " = ".join(write(syntax_tree(side), letters) for side in text.split("="))


def _plain(node: ast.expr, letters: Mapping[str, str]) -> str:
    for one in ast.walk(node):
        if isinstance(one, ast.Name):
            letter = stem(one.id)
            one.id = letters.get(one.id, letters.get(letter, letter) + one.id[len(letter) :])
    return re.sub(r" ([*/^]) ", r"\1", ast.unparse(node).replace("**", "^"))
