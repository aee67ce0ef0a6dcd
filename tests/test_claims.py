"""The claims of chapters 3 to 5: verdicts that follow from numbers, not from opinion."""

from math import pi

import numpy as np
import pytest

import generated.double_pendulum as dp
from solvers.claims import Evidence, Setting, claims

PROSE = Setting(dp.DEFAULTS, (pi / 2, pi, 0.0, 0.0), 5.0)
FIRST = Setting((1.0, 1.0, 1.0, 1.0, 9.81), PROSE.y0, 5.0)
SECOND = Setting(dp.DEFAULTS, (pi / 2, pi, pi, 2 * pi), 5.0)
THIRD = Setting(dp.DEFAULTS, (0.0, -pi / 4, 0.0, 0.0), 50.0)


@pytest.fixture(scope="module")
def evidence() -> Evidence:
    return Evidence(dp, PROSE, FIRST, SECOND, THIRD)


def test_each_claim_has_its_verdict_and_a_number_or_a_reason(evidence: Evidence) -> None:
    found = claims(evidence)
    assert {claim.id: claim.verdict for claim in found} == {
        "3.1a": "contradicted", "3.1b": "untestable", "3.1c": "untestable",
        "3.2a": "contradicted", "3.2b": "untestable", "3.3a": "contradicted",
        "3.3b": "contradicted", "3.3c": "untestable", "3.3d": "untestable",
        "4.1": "untestable", "4.2": "supported", "4.3": "contradicted",
        "5a": "supported", "5b": "supported", "5c": "untestable", "5d": "supported",
        "5e": "supported", "B3": "supported",
    }  # fmt: skip
    assert all(
        any(letter.isdigit() for letter in claim.number)
        for claim in found
        if claim.verdict != "untestable"
    )


def test_verdicts_change_with_the_facts() -> None:
    # had all programs been set to what the prose says, these claims would stand
    honest = Evidence(dp, PROSE, PROSE, PROSE, THIRD)
    verdicts = {claim.id: claim.verdict for claim in claims(honest)}
    assert verdicts["3.1a"] == verdicts["3.2a"] == "supported"


def test_the_reference_is_the_known_state(evidence: Evidence) -> None:
    expected = (2.2280642400930692, -0.2670447339117043, -1.9694093323354762, -2.9859792219408772)
    assert np.abs(evidence.end - expected).max() < 1e-10
    assert evidence.disagreement < 1e-10
