"""Objectives, claims and recommendations: verdicts that follow from numbers, not from opinion."""

import re
from math import pi

import numpy as np
import pytest

import generated.double_pendulum as dp
from solvers.app.commands.chart import DEFAULT
from solvers.app.verdict.claims import _chapter_5, claims, objectives, recommendations
from solvers.app.verdict.evidence import Evidence
from solvers.references.taylor import taylor
from solvers.scenes.scene import Scene
from solvers.studies.failure_modes.lyapunov import Mean
from solvers.studies.failure_modes.study import studies

EQUATIONS = {"verified": 119, "misprint": 23}
PROSE = Scene(dp, dp.DEFAULTS, (pi / 2, pi, 0.0, 0.0), 5.0)
FIRST = Scene(dp, (1.0, 1.0, 1.0, 1.0, 9.81), PROSE.y0, 5.0)
SECOND = Scene(dp, dp.DEFAULTS, (pi / 2, pi, pi, 2 * pi), 5.0)
THIRD = Scene(dp, dp.DEFAULTS, (0.0, -pi / 4, 0.0, 0.0), 50.0)


@pytest.fixture(scope="module")
def evidence() -> Evidence:
    return Evidence(PROSE, FIRST, SECOND, THIRD)


def test_each_claim_has_its_verdict_and_a_number_or_a_reason(evidence: Evidence) -> None:
    found = [*objectives(evidence, EQUATIONS), *claims(evidence), *recommendations(evidence)]
    assert {claim.id: claim.verdict for claim in found} == {
        "1.6-1": "supported",
        "1.6-2": "contradicted",
        "1.6-3": "contradicted",
        "3.1a": "contradicted",
        "3.1b": "untestable",
        "3.1c": "untestable",
        "3.2a": "contradicted",
        "3.2b": "untestable",
        "3.3a": "contradicted",
        "3.3b": "contradicted",
        "3.3c": "untestable",
        "3.3d": "untestable",
        "4.1": "untestable",
        "4.2": "supported",
        "4.3": "contradicted",
        "5a": "supported",
        "5b": "supported",
        "5c": "untestable",
        "5d": "supported",
        "5e": "supported",
        "B3": "supported",
        "5f": "supported",
        "5g": "supported",
        "5h": "supported",
    }
    assert all(
        any(letter.isdigit() for letter in claim.number)
        for claim in found
        if claim.verdict != "untestable"
    )


def test_figures_that_verdicts_name_are_drawn_by_the_commands_they_name(
    evidence: Evidence,
) -> None:
    drawn = {
        "chart": {
            f"{kind}_{name}.png"
            for kind in ("work_precision", "steps", "energy")
            for name in DEFAULT
        },
        "stability": {f"failures_{study.name}.png" for study in studies()},
    }
    shown = {claim.figure for claim in claims(evidence) if claim.figure}
    assert len(shown) >= 4
    for figure in shown:
        command, name = figure.removeprefix("holonomic ").split(": ")
        assert name in drawn[command]


def test_a_wrong_equation_or_a_better_rk4_would_change_the_objectives_verdicts(
    evidence: Evidence, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = {o.id: o.verdict for o in objectives(evidence, EQUATIONS | {"wrong": 1})}
    assert found["1.6-1"] == "contradicted"
    monkeypatch.setattr(Evidence, "calls", lambda _, method, error: 10 + (method != "rk4"))
    found = {o.id: o.verdict for o in objectives(evidence, EQUATIONS)}
    assert found["1.6-3"] == "supported"
    monkeypatch.setattr(Evidence, "exponent", lambda _, **masses: Mean(1.0, 0.1))
    advice = {o.id: o.verdict for o in recommendations(evidence)}
    assert advice["5g"] == advice["5h"] == "contradicted"


@pytest.mark.long("decimal references of a chaotic motion")
def test_the_growth_of_a_difference_is_that_of_the_motions(
    evidence: Evidence, monkeypatch: pytest.MonkeyPatch
) -> None:
    def verdict() -> tuple[str, list[float]]:
        (claim,) = (claim for claim in _chapter_5(evidence) if claim.id == "5a")
        growth = re.findall(r"factor of (\S+) in 5 s and of (\S+) in 20 s", claim.number)
        return claim.verdict, [*map(float, *growth)]

    monkeypatch.setattr(Evidence, "error", lambda *_: 1.0)  # of other claims
    shown = []
    for t in (5, 20):
        starts = PROSE.y0, (PROSE.y0[0] + 1e-9, *PROSE.y0[1:])
        one, other = (taylor(dp, PROSE.params, y0, [0, t], 24)[-1] for y0 in starts)
        shown.append(pytest.approx(np.linalg.norm(one - other) / 1e-9, rel=0.01))
    assert verdict() == ("supported", shown)
    monkeypatch.setattr(Evidence, "divergence", lambda _, __, duration: 45.0 * duration)
    assert verdict() == ("contradicted", [225, 900])


def test_right_hand_sides_are_counted_to_an_error(evidence: Evidence) -> None:
    assert evidence.calls("rk4", 1e-9) > 4 * evidence.calls("rk4", 1e-6) > 0
    assert evidence.calls("verner98", 1e-9) < evidence.calls("rk4", 1e-9) / 10
    with pytest.raises(RuntimeError, match="does not come within"):
        evidence.calls("dp54", 0.0)


def test_verdicts_change_with_the_facts() -> None:
    # had all programs been set to what the prose says, these claims would stand
    honest = Evidence(PROSE, PROSE, PROSE, THIRD)
    verdicts = {claim.id: claim.verdict for claim in claims(honest)}
    assert verdicts["3.1a"] == verdicts["3.2a"] == "supported"


def test_the_reference_is_the_known_state(evidence: Evidence) -> None:
    expected = (2.2280642400930692, -0.2670447339117043, -1.9694093323354762, -2.9859792219408772)
    assert np.abs(evidence.end - expected).max() < 1e-15
    assert evidence.references_apart < 1e-12
    assert evidence.disagreement < 1e-10
