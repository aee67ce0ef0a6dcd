"""Exported files in every language, also in those that are not installed."""

from dataclasses import replace
from pathlib import Path

import pytest
from recording import Record
from valid_files import BEAD

from derive import Simulation, System, load
from derive.codegen.export.language_export import exported_text
from derive.codegen.export.target import find_targets
from solvers.runge_kutta import method_catalogue


@pytest.fixture
def systems(tmp_path: Path) -> dict[str, System]:
    """A shaken bead with friction, and a body with a skate."""
    (tmp_path / "bead.toml").write_text(BEAD, encoding="utf-8")
    return {"bead": load(tmp_path / "bead.toml"), "sleigh": load("chaplygin_sleigh")}


def test_exported_functions_are_as_recorded(record: Record, systems: dict[str, System]) -> None:
    record.check_digests({
        f"{name} {target}": exported_text(system, target, None)[1]
        for name, system in systems.items()
        for target, one in find_targets().items()
        if one.has_libraries
    })  # fmt: skip


def test_exported_simulations_are_as_recorded(record: Record, systems: dict[str, System]) -> None:
    method = method_catalogue.load("dp54")
    fixed = Simulation(method, (1.0, 0.5, 0.1, 0.2, 3.0, 9.81), (1.0, 0.0), 2.0, samples=4, steps=3)
    controlled = replace(fixed, method=method_catalogue.load("verner853"), steps=0, rtol=1e-8)
    record.check_digests({
        f"{kind} {target}": exported_text(systems["bead"], target, simulation)[1]
        for target, one in find_targets().items()
        for kind, simulation in (
            ("fixed", fixed), ("event", replace(controlled, event=("x", 0.25))),
        )
        if one.has_simulations
        and not (kind == "event" and not (one.is_program or one.has_events))
        and not (one.has_fixed_steps and not simulation.steps)
        and not ("advance" in one.entry and simulation.steps)
    })  # fmt: skip
