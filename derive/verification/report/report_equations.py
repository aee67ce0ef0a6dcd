"""The equations of the report: its LaTeX, with the details that the text does not state.

Their translations are stored, so that the verdicts on them need no parsing library:
``python -m derive.verification.report.report_equations`` writes them anew; a test compares them
with the LaTeX.
"""

import json
import re
from functools import cache
from pathlib import Path

from derive.reading.document_formats import read_document
from derive.verification.report.details import DETAILS
from derive.verification.report.equation import Details, ReportEquation
from derive.verification.report.report_latex import STORED, read
from solvers.io.atomic_write import write_text

FILE = Path(__file__).with_name("equations.md")
TAG = re.compile(r"\s*\\tag\{(\w+)\}\s*$")


@cache
def equations() -> dict[str, ReportEquation]:
    """The equations by id, in printed order."""
    table = {}
    for display in read_document(FILE).displays:
        tag = TAG.search(display.latex)
        if tag is None:
            raise ValueError(f"{FILE}, line {display.line}: a display without a tag")
        name = f"eq{tag[1]}" if tag[1].isdecimal() else tag[1]
        details = vars(DETAILS.get(name, Details()))
        table[name] = ReportEquation(name, display.latex[: tag.start()], **details)
    return table


def translations() -> dict[str, str]:
    """All equations and corrections by their LaTeX, read from it."""
    latex = [one for e in equations().values() for one in (e.latex, e.corrected_latex)]
    return {one: read(one) for one in latex}


if __name__ == "__main__":
    write_text(STORED, json.dumps(translations(), indent=0) + "\n")
