"""Objectives, claims and recommendations: verdicts that follow from numbers, not from opinion."""

import re
from dataclasses import replace
from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import generated.double_pendulum as dp
from solvers.app.commands.chart import DEFAULT
from solvers.app.report_evidence import Evidence
from solvers.app.report_verdicts import _chapter_3, _chapter_5, claims, objectives, recommendations
from solvers.references.taylor import taylor
from solvers.scenes.scene import Scene
from solvers.studies.failure_modes.chaos import Mean
from solvers.studies.failure_modes.study import studies

EQUATIONS = {"verified": 119, "misprint": 23}
PROSE = Scene(dp, dp.DEFAULTS, (pi / 2, pi, 0.0, 0.0), 5.0)
FIRST = Scene(dp, (1.0, 1.0, 1.0, 1.0, 9.81), PROSE.y0, 5.0)
SECOND = Scene(dp, dp.DEFAULTS, (pi / 2, pi, pi, 2 * pi), 5.0)
THIRD = Scene(dp, dp.DEFAULTS, (0.0, -pi / 4, 0.0, 0.0), 50.0)


@pytest.fixture(scope="module")
def evidence() -> Evidence:
    return Evidence(PROSE, FIRST, SECOND, THIRD)


@pytest.mark.long("other tests reach its code")
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


def textbook(t: float, y: np.ndarray, params: tuple[float, ...]) -> np.ndarray:
    """Rates of a double pendulum: the equation of each rod, solved for the accelerations."""
    m1, m2, l1, l2, g = params
    (a, b), (u, v) = y[:2], y[2:]
    coupling = m2 * l1 * l2 * np.cos(a - b)
    matrix = [[(m1 + m2) * l1**2, coupling], [coupling, m2 * l2**2]]
    turn = m2 * l1 * l2 * np.sin(a - b)
    torques = [-turn * v**2 - (m1 + m2) * g * l1 * np.sin(a), turn * u**2 - m2 * g * l2 * np.sin(b)]
    return np.array([u, v, *np.linalg.solve(matrix, torques)])


def above_rest(y: np.ndarray, params: tuple[float, ...]) -> np.ndarray:
    """The energy of states in columns, from the positions and velocities of the bobs."""
    m1, m2, l1, l2, g = params
    first, second = (
        rod * np.exp(1j * angle) * rate
        for rod, angle, rate in zip((l1, l2), y[:2], y[2:], strict=True)
    )
    heights = l1 * (1 - np.cos(y[0])), l2 * (1 - np.cos(y[1]))
    kinetic = m1 * abs(first) ** 2 / 2 + m2 * abs(first + second) ** 2 / 2
    return kinetic + m1 * g * heights[0] + m2 * g * (heights[0] + heights[1])


def by_hand(scene: Scene, h: float, order: int) -> np.ndarray:
    """States after every step of Euler's method or of that of order 4."""
    states, params = [np.array(scene.y0)], scene.params
    for _ in range(round(scene.duration / h)):
        y = states[-1]
        k = [textbook(0.0, y, params)]
        for part in (0.5, 0.5, 1.0) if order == 4 else ():
            k.append(textbook(0.0, y + part * h * k[-1], params))
        weights = (1, 2, 2, 1) if order == 4 else (1,)
        states.append(y + h * np.average(k, axis=0, weights=weights))
    return np.transpose(states)


@pytest.mark.long("other tests reach its code")
def test_numbers_in_the_verdicts_are_those_of_another_program(evidence: Evidence) -> None:
    texts = {claim.id: claim.number for claim in claims(evidence)}

    def shown(name: str, before: str) -> float:
        return float(texts[name].partition(before)[2].split()[0].rstrip(",;"))

    times = np.linspace(0, 5, 5001)
    prose, first, second = (
        solve_ivp(textbook, (0, 5), one.y0, "DOP853", times, args=(one.params,), rtol=1e-11,
            atol=1e-11).y for one in (PROSE, FIRST, SECOND)
    )  # fmt: skip
    ends = [np.abs(a[:2, -1] - b[:2, -1]).max() for a, b in ((first, prose), (first, second))]
    assert shown("3.1a", "angles differ by") == pytest.approx(ends[0], rel=0.05)
    assert shown("3.2a", "angles differ by") == pytest.approx(ends[1], rel=0.05)
    for states, before in ((first, "half is"), (prose, "in program 1,")):
        speed = np.abs(states[2:]).sum(axis=0)
        ratio = speed[2500:].mean() / speed[:2500].mean()
        assert shown("3.1b", before) == pytest.approx(ratio, abs=0.01)
    assert shown("4.1", "sweeps") == pytest.approx(np.ptp(prose[1]) / (2 * pi), abs=0.006)
    euler, rk4 = by_hand(PROSE, 0.01, 1), by_hand(PROSE, 0.01, 4)
    energy = above_rest(euler, PROSE.params)
    change = np.abs(energy / energy[0] - 1).max()
    assert shown("4.2", "energy is") == pytest.approx(100 * change, abs=0.51)
    error = np.abs(euler - prose[:, ::10])[:2, -1].max()
    assert shown("4.2", "angles") == pytest.approx(error, rel=0.05)
    assert shown("3.3b", "vertical") == np.count_nonzero(np.diff(np.sign(rk4[0])))
    rough = np.abs(by_hand(PROSE, 0.1, 4) - prose[:, ::100])[:2, -1].max()
    assert shown("4.3", "5 s is") == pytest.approx(rough, rel=0.05)


@pytest.mark.long("other tests reach its code")
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


@pytest.mark.long("other tests reach its code")
def test_verdicts_change_with_the_facts() -> None:
    # had all programs been set to what the prose says, these claims would stand
    honest = Evidence(PROSE, PROSE, PROSE, THIRD)
    verdicts = {claim.id: claim.verdict for claim in _chapter_3(honest)}
    assert verdicts["3.1a"] == verdicts["3.2a"] == "supported"
    almost = replace(PROSE, y0=(PROSE.y0[0] + 0.01, *PROSE.y0[1:]))
    verdicts = {claim.id: claim.verdict for claim in _chapter_3(replace(honest, first=almost))}
    assert verdicts["3.1a"] == verdicts["3.2a"] == "contradicted"


def test_the_reference_is_the_known_state(evidence: Evidence) -> None:
    expected = (2.2280642400930692, -0.2670447339117043, -1.9694093323354762, -2.9859792219408772)
    assert np.abs(evidence.end - expected).max() < 1e-15
    assert evidence.references_apart < 1e-12
    assert evidence.disagreement < 1e-10


class Invented(Evidence):
    """Errors of `size` h^p rad of a method of order p, final angles `apart`, and other numbers."""

    size, apart = 7.0, 0.0
    end, references_apart, disagreement = np.zeros(4), 0.0, 0.0
    growth = 1.0

    def error(self, method: str, h: float) -> float:
        return self.size * h ** int(method[2])

    def motion(self, scene: Scene, times: object = None) -> np.ndarray:
        return np.full((4, 1), self.apart)

    def stepped(self, *_: object) -> np.ndarray:
        return np.zeros((4, 1))

    def energy_change(self, *_: object) -> float:
        return 0.0

    def speed_ratio(self, *_: object) -> float:
        return 1.0

    def calls(self, *_: object) -> int:
        return 1

    def divergence(self, _: float, duration: float) -> float:
        return self.growth**duration

    def exponent(self, **_: float) -> Mean:
        return Mean(1.0, 0.1)


def test_errors_in_verdicts_are_those_of_the_stated_steps() -> None:
    e = Invented(PROSE, FIRST, SECOND, THIRD)
    rows = [*objectives(e, EQUATIONS), *claims(e), *recommendations(e)]
    texts = {claim.id: claim.number for claim in rows}
    for name, words in (
        ("1.6-2", "h = 0.01 s the error of RK1 is 0.07 rad and that of RK4 7e-08 rad"),
        ("3.3c", "h = 0.01 s the errors of methods of orders 1 to 4 are 0.07, 0.0007, 7e-06,"),
        ("4.2", "h = 0.01 s the error of the energy is 0 % and that of the angles 0.07 rad"),
        ("4.3", "h = 0.1 s is also smooth, but its error at 5 s is 0.0007 rad"),
        ("5d", "0.35 rad with h = 0.05 s and 0.0007 rad with h = 0.0001 s"),
        ("5e", "4.4e-05 and 0.35 rad with h = 0.05 s, 7e-16 and 0.0007 rad with h = 0.0001 s"),
        ("5e", "with h = 0.1 s that of RK4 is 0.0007 rad"),
        ("5f", "0.07, 0.007, 0.0007 rad with h = 0.01, 0.001, 0.0001 s"),
        ("5f", "that of RK4 is 1e-06 rad with h = 0.02 s"),
    ):
        assert words in texts[name]
    listed = re.findall(r"([\d.e-]+) \(h = ([\d.e-]+) s\)", texts["3.3a"])
    assert all(error == f"{7 * float(h) ** 4:.1g}" for error, h in listed)
    steps = [float(h) for _, h in listed]
    assert steps == sorted(steps, reverse=True)
    assert (steps[0], steps[-1]) == (0.2, 5e-4)


@pytest.mark.parametrize(("name", "number", "within", "beyond"), [
    ("3.1a", "apart", 0.9e-3, 1.1e-3),
    ("4.2", "size", 11.0, 9.0),  # 0.11 and 0.09 rad with h = 0.01 s
    ("4.3", "size", 9.0, 11.0),  # 0.9 and 1.1 mrad of RK4 with h = 0.1 s
    ("5a", "growth", 1.42, 1.40),  # over 20 s
    ("5b", "disagreement", 0.9e-8, 1.1e-8),
    ("5d", "size", 2.1, 1.9),  # with h = 0.05 s
    ("5d", "size", 990.0, 1100.0),  # with h = 0.0001 s
])  # fmt: skip
def test_claims_hold_up_to_the_numbers_that_decide(
    name: str, number: str, within: float, beyond: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    for value, verdict in ((within, "supported"), (beyond, "contradicted")):
        monkeypatch.setattr(Invented, number, value)
        found = {claim.id: claim.verdict for claim in claims(Invented(PROSE, FIRST, SECOND, THIRD))}
        assert found[name] == verdict
