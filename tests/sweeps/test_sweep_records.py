"""Summaries and plots of the sweeps that ship, with few and short motions."""

import re
from pathlib import Path

from figure_descriptions import described
from recording import Record

from solvers.app.modules import load as load_module
from solvers.sweeps.definition import sweep_reading
from solvers.sweeps.execution.sweep_run import sweep
from solvers.sweeps.sweep_figure import figure
from solvers.sweeps.sweep_summary import summary

#: Numbers of motions, and durations.
FEWER = {
    "basins": {"count": 5, "skip": 20},
    "bifurcations": {"to": 0.5, "count": 7, "skip": 4},  # without chaos
    "response": {"count": 3},
    "lyapunov": {"count": 4, "duration": 5},
    "henon_heiles": {"count": 3, "duration": 40},
    "flips": {"count": 6, "duration": 5},
}
#: Tolerances below which roundings, which differ between compilers, reach no digit that is shown.
TIGHT = "rtol = 1e-12\natol = 1e-12\n"


def test_sweeps_are_as_recorded(record: Record, tmp_path: Path) -> None:
    texts = {}
    for name, fewer in FEWER.items():
        shipped = Path(sweep_reading.__file__).parents[1] / "files" / f"{name}.toml"
        text = TIGHT + shipped.read_text(encoding="utf-8")
        for key, value in fewer.items():
            text = re.sub(rf"\b{key} = \d+", f"{key} = {value}", text)
        (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")
        definition = sweep_reading.find(str(tmp_path / f"{name}.toml"), load_module)
        results = sweep(definition, tmp_path / name)
        texts[name] = "\n\n".join([*summary(results, None, {}), described(figure(results))])
    record.check_digests(texts)
