"""Translations of the report's equations, stored so that its verdicts need no parsing library.

``python -m derive.verification.report.translations`` writes them anew; a test compares them with
the LaTeX.
"""

import json

from derive.verification.report.report_equations import equations
from derive.verification.report.report_latex import STORED, read
from solvers.io.atomic_write import write_text


def translations() -> dict[str, str]:
    """All equations and corrections by their LaTeX, read from it."""
    latex = [one for e in equations().values() for one in (e.latex, e.corrected_latex)]
    return {one: read(one) for one in latex}


if __name__ == "__main__":
    write_text(STORED, json.dumps(translations(), indent=0) + "\n")
