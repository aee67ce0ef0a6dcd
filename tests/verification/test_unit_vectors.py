"""Positions, velocities and accelerations that are written with unit vectors along fixed axes."""

from pathlib import Path

import pytest

from derive.reading.document_formats import read_document
from derive.verification.documents.judgement import judge_document

#: A bead on a cone about a vertical axis.
CONE = r"""$$\vec r = s\sin\alpha\,(\cos\phi\,\hat i + \sin\phi\,\hat j) - s\cos\alpha\,\hat k$$
$$\vec v = (\dot s\sin\alpha\cos\phi - s\dot\phi\sin\alpha\sin\phi)\,\hat i
+ (\dot s\sin\alpha\sin\phi + s\dot\phi\sin\alpha\cos\phi)\,\hat j - \dot s\cos\alpha\,\hat k$$
$$T = \frac12 m(\dot s^2 + s^2\sin^2\alpha\,\dot\phi^2)$$
$$V = m g z = -m g s\cos\alpha$$
$$m\ddot s = m s\sin^2\alpha\,\dot\phi^2 + m g\cos\alpha$$"""


def judged(folder: Path, text: str) -> list[tuple[str, str]]:
    """The verdict and the wrong term of each formula."""
    (folder / "a.md").write_text(text, encoding="utf-8")
    formulas = judge_document(read_document(folder / "a.md")).formulas
    return [(one.verdict, one.wrong_term) for one in formulas]


@pytest.mark.parametrize("units", [
    (r"\hat i", r"\hat j", r"\hat k"), (r"\mathbf i", r"\mathbf j", r"\mathbf k"),
    (r"\mathbf e_x", r"\mathbf e_y", r"\mathbf e_z"),
    (r"\hat{\mathbf N}_x", r"\hat{\mathbf N}_y", r"\hat{\mathbf N}_z"),
])  # fmt: skip
def test_positions_by_unit_vectors_state_a_system(units: tuple[str, ...], tmp_path: Path) -> None:
    text = CONE
    for old, new in zip((r"\hat i", r"\hat j", r"\hat k"), units, strict=True):
        text = text.replace(old, new)
    assert judged(tmp_path, text) == [("definition", ""), *[("verified", "")] * 4]


@pytest.mark.parametrize(("right", "slip", "number", "term"), [
    (r"\dot\phi\sin\alpha\cos\phi)", r"\dot\phi\sin\alpha\sin\phi)", 1,
     r"s\dot\phi\sin\alpha\sin\phi"),
    (r"-m g s\cos", r"-m g s\sin", 3, r"-m g s\sin\alpha"),
    ("m g z =", "2 m g z =", 3, "2 m g z"),  # z is the component of r
])  # fmt: skip
def test_slips_beside_positions_by_unit_vectors_are_found(
    right: str, slip: str, number: int, term: str, tmp_path: Path
) -> None:
    found = judged(tmp_path, CONE.replace(right, slip))
    assert [k for k, (verdict, _) in enumerate(found) if verdict == "wrong"] == [number]
    assert found[number][1].replace(" ", "") == term.replace(" ", "")


def test_a_position_decides_between_an_energy_and_an_equation(tmp_path: Path) -> None:
    before, _, rest = CONE.partition(r"$$\vec v")
    energies = "$$T" + rest.partition("$$T")[2]
    text = before + energies.replace(r"m g z = -m g s\cos", r"-m g s\sin")
    assert [verdict for verdict, _ in judged(tmp_path, text)] == [
        "definition", "verified", "wrong", "verified",
    ]  # fmt: skip


@pytest.mark.parametrize("velocity", [
    r"(\dot x - \omega y)\,\hat i + (\dot y + \omega x)\,\hat j",
    r"\dot x\,\hat i + \dot y\,\hat j",
])  # fmt: skip
def test_unit_vectors_of_a_turning_frame_state_nothing(velocity: str, tmp_path: Path) -> None:
    text = rf"""$$\vec r = x\,\hat i + y\,\hat j$$ $$\vec v = {velocity}$$
$$T = \frac12 m[(\dot x - \omega y)^2 + (\dot y + \omega x)^2]$$ $$V = \frac12 k(x^2 + y^2)$$
$$m\ddot x - 2 m\omega\dot y - m\omega^2 x + k x = 0$$"""
    found = judged(tmp_path, text)
    assert [verdict for verdict, _ in found if verdict == "wrong"] == []
    assert found[-1][0] == "verified"


def test_unit_vectors_can_turn_with_a_hoop(tmp_path: Path) -> None:
    text = r"""$$\vec r = R\sin\theta\,\hat i - R\cos\theta\,\hat k$$
$$\vec v = R\dot\theta\cos\theta\,\hat i + R\Omega\sin\theta\,\hat j
+ R\dot\theta\sin\theta\,\hat k$$
$$T = \frac12 m R^2(\dot\theta^2 + \Omega^2\sin^2\theta)$$ $$V = -m g R\cos\theta$$
$$\ddot\theta = \Omega^2\sin\theta\cos\theta - \frac gR\sin\theta$$"""
    found = [verdict for verdict, _ in judged(tmp_path, text)]
    assert found == ["context"] * 2 + ["verified"] * 3


def test_unit_vectors_that_a_document_defines_are_not_those_of_fixed_axes(tmp_path: Path) -> None:
    text = r"""$$\hat i = \cos\Omega t\,\hat X + \sin\Omega t\,\hat Y$$
$$\hat j = -\sin\Omega t\,\hat X + \cos\Omega t\,\hat Y$$
$$\vec r = l\sin\theta\,\hat i - l\cos\theta\,\hat j$$
$$\vec v = (l\cos\theta\,\dot\theta + \Omega l\cos\theta)\,\hat i
+ (l\sin\theta\,\dot\theta + \Omega l\sin\theta)\,\hat j$$
$$T = \frac12 m l^2(\dot\theta + \Omega)^2$$ $$\ddot\theta = 0$$"""
    assert "wrong" not in {verdict for verdict, _ in judged(tmp_path, text)}


@pytest.mark.parametrize("velocity", [r"\dot{\vec r}^2", r"\dot{\vec r}\cdot\dot{\vec r}"])
def test_the_square_of_a_vector_is_that_of_its_length(velocity: str, tmp_path: Path) -> None:
    text = rf"""$$\vec r = \begin{{pmatrix}} l\sin\phi \\ -l\cos\phi \end{{pmatrix}}$$
$$T = \frac12 m{velocity} = \frac12 m l^2\dot\phi^2$$ $$V = -m g l\cos\phi$$
$$\ddot\phi = -\frac gl\sin\phi$$"""
    assert judged(tmp_path, text) == [("definition", ""), *[("verified", "")] * 3]
    verdict, term = judged(tmp_path, text.replace("m l^2", "m l"))[1]
    assert (verdict, term.replace(" ", "")) == ("wrong", r"\frac12ml\dot\phi^2")
