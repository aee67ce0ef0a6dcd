"""Verdicts on documents of our own making: right ones, and ones with a slip at a known place."""

from pathlib import Path

import pytest
from document_campaign import CORRECT, Outcome, outcome, outcomes, random_slip, table
from document_styles import STYLES
from recording import Record
from written_documents import written_document

from derive.verification.source_files import judge_file
from solvers.runge_kutta.order_conditions import order

DEVELOPED = [name for name, style in STYLES.items() if not style.is_held_out]
#: Documents of an energy and its equations, of which often nothing decides which is wrong.
UNDECIDED = ("mechanics_exam",)
#: Styles in Markdown that state no positions, which would begin another case.
BY_ENERGIES = [
    name for name in DEVELOPED
    if STYLES[name].markup == "md" and "positions" not in STYLES[name].steps
]  # fmt: skip
#: Seeds of systems with the same coordinates: an angle, a place, a distance with an angle.
SAME_COORDINATES = [(0, 6), (1, 6), (0, 1), (5, 16), (7, 15), (7, 19)]
#: Styles and systems of documents that are judged in less than a second, each with a slip.
QUICK = {
    "lecture": 0, "notes": 1, "upright": 4, "downwards": 5, "canonical": 6, "robotics": 20,
    "french": 21,
}  # fmt: skip


def failures(results: list[Outcome]) -> list[str]:
    """Crashes, and right statements that are called wrong."""
    crashes = [f"{one.name}: {one.failure}" for one in results if one.failure]
    return crashes + [f"{one.name}: {accused}" for one in results for accused in one.accused]


@pytest.mark.long("styles; the last test here has some", daily=12)
@pytest.mark.parametrize("style", DEVELOPED)
def test_the_slip_is_found_and_no_right_formula_is_accused(style: str, tmp_path: Path) -> None:
    results = [*outcomes([style], [3, 10, 15], tmp_path)]
    assert failures(results) == []
    numbers = table(results)
    assert numbers["found"] >= 65 or style in UNDECIDED
    assert numbers["judged"] >= 75


@pytest.mark.long("other pairs", daily=18)
@pytest.mark.parametrize("seeds", SAME_COORDINATES)
@pytest.mark.parametrize("style", BY_ENERGIES)
def test_two_right_documents_in_one_file_are_not_accused(
    style: str, seeds: tuple[int, int], tmp_path: Path
) -> None:
    pair = [written_document(STYLES[style], seed) for seed in seeds]
    parts = [f"## System {k}\n\n{one.text()}" for k, one in enumerate(pair, 1) if one]
    path = tmp_path / "document.md"
    path.write_text("\n\n".join(parts), encoding="utf-8")
    formulas = judge_file(str(path), order)[0].formulas
    assert [one.latex for one in formulas if one.verdict == "wrong"] == []
    assert sum(one.verdict in CORRECT for one in formulas) >= 0.75 * len(formulas)


@pytest.mark.campaign
@pytest.mark.parametrize("is_held_out", [False, True])
def test_most_slips_are_found_at_their_term(is_held_out: bool, tmp_path: Path) -> None:
    styles = [name for name, style in STYLES.items() if style.is_held_out == is_held_out]
    results = [*outcomes(styles, range(20), tmp_path)]
    numbers = table(results)
    print(numbers)
    assert failures(results) == []
    assert numbers["found"] >= 80
    assert numbers["at the term"] >= 90
    assert numbers["mended"] >= 95
    assert numbers["judged"] >= 75


@pytest.mark.long("other tests reach its code")
def test_verdicts_on_documents_with_a_slip_are_as_recorded(record: Record, tmp_path: Path) -> None:
    lines = []
    for style, seed in QUICK.items():
        document = written_document(STYLES[style], seed)
        assert document
        slip = random_slip(document, seed)
        result = outcome(style, document, slip, tmp_path)
        # what is true needs no record
        assert failures([result]) == []
        assert slip
        assert result.is_found
        assert result.is_at_its_term
        assert result.is_mended
        lines += [f"{style}: {result.system}", f"  {slip.kind}: {slip.wrong}"]
        lines += [f"  {verdict} {note}".rstrip() for verdict, note in result.verdicts]
        if one := result.blamed:
            lines += [f"  wrong: {one.wrong_term}", f"  right: {one.correction}"]
            lines += [f"  {one.witness}", f"  by {one.basis}"]
    record.check("\n".join(lines))
