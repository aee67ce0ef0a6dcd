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
