"""The document of a system with friction and a cyclic coordinate, read back."""

from pathlib import Path

import pytest

from derive import Derivation, load
from derive.handout.derivation_document import write_document
from derive.reading.document_formats import read_document
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.letters.hints import hints

SPHERICAL = """
title = "Spherical pendulum with friction"
dissipation = "c*theta_dot**2/2"
coordinates = { theta = {}, phi = {} }
[parameters]
m = { value = 1, unit = "kg" }
l = { value = 1, unit = "m" }
c = { value = 0.1, unit = "N m s" }
g = { value = 9.81, unit = "m/s^2" }
[[masses]]
mass = "m"
position = ["l*sin(theta)*cos(phi)", "l*sin(theta)*sin(phi)", "-l*cos(theta)"]
"""


@pytest.mark.long("other tests reach its code")
def test_friction_of_the_system_is_counted_once(tmp_path: Path) -> None:
    path = tmp_path / "system.toml"
    path.write_text(SPHERICAL)
    (written,) = write_document(Derivation(load(path)), path.with_suffix(".tex"))
    formulas = judge_document(read_document(written), hints(str(path), None)).formulas
    assert {one.verdict for one in formulas} == {"verified", "definition"}


MOMENTUM = r"""
$$T = \frac12 m l^2\dot\theta^2, \qquad V = - m g l\cos\theta$$
$$m l^2\ddot\theta = - m g l\sin\theta - b\dot\theta$$
$$p_\theta = m l^2\dot\theta$$
$$\dot p_\theta = - m g l\sin\theta - b\dot\theta$$
"""


def test_the_rate_of_a_momentum_contains_friction(tmp_path: Path) -> None:
    def verdicts(text: str) -> list[str]:
        (tmp_path / "a.md").write_text(text)
        return [one.verdict for one in judge_document(read_document(tmp_path / "a.md")).formulas]

    assert verdicts(MOMENTUM) == ["verified"] * 5
    start, _, _ = MOMENTUM.rpartition("- b")
    assert verdicts(rf"{start}+ b\dot\theta$$") == ["verified"] * 4 + ["wrong"]
