"""Summaries and plots of scenes that ship."""

import re
from dataclasses import replace

from figure_descriptions import described
from recording import Record

from solvers.app.modules import load as load_module
from solvers.player.motion_plots import default_pictures, figure
from solvers.scenes.scene_output import figures, summary, together
from solvers.scenes.scene_reading import find
from solvers.scenes.scene_run import run_scene

#: One scene of each model, and those beside another.
SCENES = (
    "rest", "small", "one_bob", "separatrix", "rotation", "flea", "heavy_above", "program_3",
)  # fmt: skip
KEYS = "form", "precision", "code", "operations", "accuracy_met", "units"
#: Numbers that depend on the machine, or on roundings.
MEASURED = re.compile(
    r"(?<=error estimate )[\d.e+-]+|(?<=takes )\S+(?= x)|(?<=^cost: ).*|(?<=rtol = )\S+"
)


def test_summaries_of_scenes_are_as_recorded(record: Record) -> None:
    lines: list[str] = []
    for name in SCENES:
        result = run_scene(find(name, load_module))
        values = figures(result)
        lines += [MEASURED.sub("…", line) for line in summary(result)]
        lines += [" ".join(f"{key}: {values[key]}" for key in KEYS), ""]
    record.check("\n".join(lines))


def test_plots_of_scenes_are_as_recorded(record: Record) -> None:
    scene = replace(find("report", load_module), method="dop853", step=0.02, label="prose")
    beside = replace(scene, method="rk4", step=0.01, label="rk4", y0=(0.5, 1.0, 0.0, 0.0))
    motions = together([run_scene(one) for one in (scene, beside)])
    pictures = ("path", "energy", "theta1, theta2 over t", "theta2_dot over theta1")
    several = [replace(one, pictures=pictures) for one in motions]
    fixed = replace(find("spring", load_module), method="rk4", step=0.02)
    (spring,) = together([run_scene(fixed)])
    path = replace(spring, pictures=("path",))
    record.check_digests({
        "default": "\n\n".join([*default_pictures(motions[0]), *default_pictures(spring)]),
        "two": described(figure(several)),
        "spring": described(figure([path])),
    })  # fmt: skip
