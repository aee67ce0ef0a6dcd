"""The derivation beside the report: each step with the report's equations and their verdicts."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from html import escape

from derive.formulas.typeset.typesetting import Formula
from derive.mechanics.derivation import Derivation
from derive.mechanics.steps import Step
from derive.verification.judging.verdict import Verdict

#: The report's equations for each step.
EQUATIONS_OF_STEP = {
    "Positions": "eq47 eq48 eq49 eq50",
    "Velocities": "eq51 eq52 eq53 eq54",
    "Energies": "eq55 eq56",
    "Lagrangian": "eq57",
    "Euler–Lagrange equations": "eq33 eq34 eq64 eq65",
    "Mass matrix": "eq68 eq69 eq70 eq101 eq102 eq103 eq104",
    "Momenta": "eq58 eq59",
    "Hamiltonian": "eq75 eq82",
    "Hamilton's equations": "eq80 eq81 A21 A22 eq83 eq84",
}

#: Style of steps and verdicts; a page can override the colours.
STYLE = """\
.step { display: flex; flex-wrap: wrap; gap: 0.25rem 2.5rem; }
/* columns are as wide as their formulas at least: below each other where both do not fit */
.step > div { flex: 1 1 30rem; max-width: 100%; }
.formula { margin: 0.3rem 0; padding-left: 1.5rem; text-indent: -1.5rem; line-height: 1.9;
  overflow-x: auto; overflow-y: hidden; }
.formula math { text-indent: 0; padding: 0.15em 0;
  font-family: "Latin Modern Math", "STIX Two Math", "Cambria Math", "DejaVu Math TeX Gyre", math; }
.line { margin: 0.3rem 0; padding-left: 0.75rem; border-left: 0.2rem solid #009e73; }
.line.misprint { border-color: #d55e00; }
.line.definition, .line.context { border-color: #8a8f94; }
.line p { margin: 0; font-size: 0.875rem; color: var(--faint, #57606a); }
.verified .word { color: #00805d; } .misprint .word { color: #c25000; }
.misprint .printed { opacity: 0.75; }
"""


@dataclass(frozen=True)
class StepComparison:
    """A step of the derivation and the report's equations; notebooks display both."""

    step: Step
    verdicts: tuple[Verdict, ...]

    @property
    def section(self) -> str:
        """HTML: title and description, and below two columns, or one on narrow screens."""
        derived = "".join(formula.html for formula in self.step.formulas)
        printed = "".join(map(verdict_html, self.verdicts))
        columns = f'<div class="step"><div>{derived}</div><div>{printed}</div></div>'
        return f"<h3>{self.step.title}</h3><p>{self.step.words}</p>{columns}"

    def _repr_html_(self) -> str:
        return f"<style>{STYLE}</style>{self.section}"


def compare_steps(
    derivation: Derivation, verdict: Callable[[str], Verdict]
) -> Iterator[StepComparison]:
    """Yield every step of the double pendulum's derivation with the report's equations.

    Parameters
    ----------
    derivation : Derivation
        Of the double pendulum.
    verdict : callable
        Returns the verdict on an equation of the report by its id.

    Yields
    ------
    StepComparison
        From the positions to Hamilton's equations.
    """
    for step in derivation.steps:
        yield StepComparison(step, tuple(map(verdict, EQUATIONS_OF_STEP[step.title].split())))


def verdict_html(verdict: Verdict) -> str:
    """Format an equation of the report with its verdict and correction as HTML."""
    number = f"({verdict.id.removeprefix('eq')})"
    note = f" – {escape(verdict.note)}" if verdict.note else ""
    head = f'<p>{number} <span class="word">{verdict.verdict}</span>{note}</p>'
    printed = f'<div class="printed">{Formula(verdict.printed).html}</div>'
    if verdict.correction:
        printed += f"<p>should be</p>{Formula(verdict.correction).html}"
    return f'<div class="line {verdict.verdict}">{head}{printed}</div>'
