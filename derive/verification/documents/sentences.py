"""The sentence around a formula of a document."""

import re

from derive.reading.document import Display, Document

#: Characters before and after a formula in which its sentence is sought.
BEFORE, AFTER = 300, 100
#: Ends of sentences and of paragraphs.
END = re.compile(r"[.!?](?=\s)|\n\s*\n\s*\n|\\(?:section|begin\{document\})")
#: Formulas, in which there are no words.
FORMULA = re.compile(
    r"\$\$.*?\$\$|\$.*?\$|\\\[.*?\\\]|\\begin\{(\w+\*?)\}.*?\\end\{\1\}", re.DOTALL
)


def sentence(document: Document, display: Display) -> str:
    """The words of the sentence with a display, without those of its formulas."""
    start, end = display.extent
    before = document.text[max(0, start - BEFORE) : start]
    after = document.text[end : end + AFTER]
    head = END.split(_words(before))[-1]
    tail = "" if _is_end(document.text[start:end]) else END.split(_words(after))[0]
    return f"{head} {tail}"


def _words(text: str) -> str:
    """Text without formulas; a formula that ends with a full stop ends its sentence."""
    return FORMULA.sub(lambda found: ". " if _is_end(found[0]) else " ", text)


def _is_end(formula: str) -> bool:
    return re.sub(r"\\end\{\w+\*?\}", "", formula).rstrip(" $\\]\n").endswith(".")
