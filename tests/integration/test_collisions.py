"""Motions into a singularity end with the time, the state and the reason."""

import re
from pathlib import Path

import pytest

import generated.double_pendulum as dp
from solvers.app.cli import main
from solvers.app.modules import load
from solvers.equations.module import GeneratedModule
from solvers.integration.accuracy.integration_run import EndsEarlyError
from solvers.integration.ensemble import ensemble
from solvers.integration.integrate import integrate
from solvers.integration.prepare import NotFinishedError, prepare
from solvers.integration.problem.status import Status
from solvers.references.taylor import SeriesError, taylor
from solvers.scenes.scene import Scene
from solvers.scenes.scene_run import run_scene

#: A body released at the distance 1 falls to the centre of the potential -1/r after π/√8.
COLLISION = 1.1107207345395915
RADIAL = """
name = "radial"
potential = "-k*m/r"
[coordinates]
r = { unit = "m", positive = true }
[parameters]
m = { value = 1, unit = "kg" }
k = { value = 1, unit = "m^3/s^2" }
[[masses]]
mass = "m"
position = ["r", "0"]
"""
#: The same in Cartesian coordinates, whose equations contain a root.
PLANE = RADIAL.replace("-k*m/r", "-k*m/sqrt(x**2 + y**2)").replace(
    'r = { unit = "m", positive = true }', 'x = { unit = "m" }\ny = { unit = "m" }'
)
SYSTEMS = {"radial": RADIAL, "plane": PLANE.replace('["r", "0"]', '["x", "y"]')}


@pytest.fixture(params=SYSTEMS)
def falling(request: pytest.FixtureRequest, tmp_path: Path) -> GeneratedModule:
    path = tmp_path / "fall.toml"
    path.write_text(SYSTEMS[request.param])
    return load(str(path))


def start(module: GeneratedModule) -> dict[str, float]:
    return {q: float(q in "rx") for q in module.COORDINATES}


@pytest.mark.long("more cases of the same kind", keep=1)
@pytest.mark.filterwarnings("ignore::solvers.integration.checks.predictability.UnfinishedWarning")
def test_every_integration_ends_at_a_collision_with_a_status(falling: GeneratedModule) -> None:
    y0 = start(falling)
    for options in ({}, {"backend": "python"}, {"method": "dop853"}, {"method": "RK45"}):
        solution = integrate(falling, (0, 5), y0, {}, **options)  # type: ignore[arg-type]
        assert solution.status in (Status.STEP_TOO_SMALL, Status.OUTSIDE_DOMAIN)
        assert solution.end[0] == pytest.approx(COLLISION, abs=1e-6)
        assert re.search(r"singularity|positive fell to 0", solution.message)
        assert f"t = {solution.end[0]}, {falling.STATE[0]} = " in solution.message
    motions = ensemble(falling, (0, 5), {q: [y0[q], 2 * y0[q]] for q in y0}, {})
    assert motions.t == pytest.approx([COLLISION, COLLISION * 8**0.5], abs=1e-6)
    assert not motions.success.any()
    with pytest.raises(NotFinishedError, match=r"t = 1\.11072.*, y = "):
        prepare(falling, {})((0, 5), y0)


def test_a_scene_states_where_its_motion_ends(falling: GeneratedModule) -> None:
    y0 = tuple({**dict.fromkeys(falling.STATE, 0.0), **start(falling)}.values())
    for changes in ({}, {"model": "full"}, {"method": "rk4"}):
        scene = Scene(falling, falling.DEFAULTS, y0, 5.0, **changes)  # type: ignore[arg-type]
        with pytest.raises(EndsEarlyError, match=r"t = 1\.11.*end the motion before"):
            run_scene(scene)


def test_the_command_reports_a_collision(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "fall.toml").write_text(RADIAL)
    path = tmp_path / "scene.toml"
    path.write_text('system = "fall.toml"\nduration = "5 s"\n[initial]\nr = "1 m"\n')
    assert main(["run", str(path), "--output", str(tmp_path / "out")]) == 3
    assert "t = 1.11072" in capsys.readouterr().err


@pytest.mark.parametrize("digits", [16, 40])
def test_series_end_at_a_collision_and_at_their_budget(digits: int, tmp_path: Path) -> None:
    path = tmp_path / "radial.toml"
    path.write_text(RADIAL)
    radial = load(str(path))
    with pytest.raises(SeriesError, match=r"singularity \(t = 1\.11072\d+, y = \d\.\d+e-\d+, -"):
        taylor(radial, radial.DEFAULTS, (1.0, 0.0), [0, 5], digits)
    for end in (0.5, 1.0):  # it is regular before
        taylor(radial, radial.DEFAULTS, (1.0, 0.0), [0, end], digits)
    with pytest.raises(SeriesError, match=rf"{digits} digits take more than 1e\+06 products .t = "):
        taylor(dp, dp.DEFAULTS, (1.0, 2.0, 0.0, 0.0), [0, 1e6], digits, max_products=1e6)
