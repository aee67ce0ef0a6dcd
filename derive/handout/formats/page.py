"""Documents as pages: one HTML file without references to other files."""

from html import escape
from pathlib import Path

from derive.formulas.typeset.typesetting import elements
from derive.handout.document_model import (
    Block,
    Code,
    HandoutDocument,
    HandoutTable,
    NumberedEquation,
    Paragraph,
    pieces,
)
from derive.handout.formats.tex import aligned
from solvers.io.html_page import html_page

STYLE = Path(__file__).with_name("page.css")
#: The LaTeX of a formula, for programs; the formula is shown as several elements.
SOURCE = (
    '<math class="source" display="block" aria-hidden="true"><semantics><mrow></mrow>'
    '<annotation encoding="application/x-tex">{}</annotation></semantics></math>'
)
BLANK = '<span class="blank"></span>'


def page(document: HandoutDocument) -> str:
    """The text of an ``.html`` file."""
    parts = [f"<h1>{escape(document.title)}</h1>"]
    for number, section in enumerate(document.sections, 1):
        parts.append(f"<h2>{number}. {escape(section.title)}</h2>")
        parts += map(_block, section.blocks)
    return html_page(document.title, "\n".join(parts), STYLE.read_text(encoding="utf-8"))


def _block(block: Block) -> str:
    match block:
        case Paragraph(text):
            return f"<p>{_text(text)}</p>"
        case NumberedEquation(number=number):
            formula = f'<div class="formula">{_formula(block)}</div>'
            label = f'<span class="number">({number})</span>'
            source = "" if block.is_blank else SOURCE.format(escape(aligned(block)))
            return f'<div class="equation" id="formula-{number}">{formula}{label}{source}</div>'
        case HandoutTable(head, rows):
            titles = "".join(f"<th>{_text(cell)}</th>" for cell in head)
            lines = ("".join(f"<td>{_text(cell)}</td>" for cell in row) for row in rows)
            body = "".join(f"<tr>{line}</tr>\n" for line in lines)
            return (
                f'<div class="table"><table>\n<thead><tr>{titles}</tr></thead>\n'
                f"<tbody>\n{body}</tbody>\n</table></div>"
            )
        case Code(language, text):
            return f"<p>{escape(language)}:</p>\n<pre><code>{escape(text)}</code></pre>"


def _formula(equation: NumberedEquation) -> str:
    if not equation.is_blank:
        sides = equation.sides
        return " ".join(elements(sides, ["="] * (len(sides) - 1)))
    before, after = equation.known
    parts = [" ".join(elements([side], [])) for side in before]
    parts += [BLANK, *(" ".join(elements([side], [])) for side in after)]
    return "<math><mo>=</mo></math>".join(parts)


def _text(text: str) -> str:
    return "".join(
        "".join(elements([piece.tree], [])) if piece.tree else escape(piece.text)
        for piece in pieces(text)
    )
