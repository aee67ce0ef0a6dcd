"""Pages that integrate, in a real browser: bits of the motion, dragging, address, comparison."""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from time import monotonic

import numpy as np
import pytest
from browser import Player

import generated.double_pendulum as dp
from derive import Simulation, load
from derive.codegen.export.language_export import exported_text
from solvers import LivePage, integrate, load_scene
from solvers.app.live_page import METHOD, STEP
from solvers.runge_kutta import method_catalogue

FOUR_BAR = """
system = "four_bar"
duration = "4 s"
[initial]
phi = "1"
phi_dot = "2"
"""
TOP = """
system = "heavy_top"
duration = "3 s"
[initial]
theta = "0.5"
psi_dot = "60"
"""


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The live page of a scene, written once."""
    folder, paths = tmp_path_factory.mktemp("pages"), dict[str, Path]()

    def path(scene: str) -> Path:
        if scene not in paths:
            name = str(len(paths))
            if "=" in scene:
                (folder / f"{name}.toml").write_text(scene)
            paths[scene] = folder / f"{name}.html"
            LivePage(folder / f"{name}.toml" if "=" in scene else scene).write(paths[scene])
        return paths[scene]

    return path


def show(player: Player, path: Path, address: str = "") -> None:
    """Open a page without playing."""
    features = [{"name": "prefers-reduced-motion", "value": "reduce"}]
    player.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
    metrics = {"width": 1280, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    player.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    player.driver.get("about:blank")
    player.driver.get(path.as_uri() + address)
    player.settle()


def state(player: Player) -> list[float]:
    """Coordinates, velocities and energy of the first motion."""
    return [*map(float, str(player.js("document.documentElement.dataset.state")).split(","))]


def play_until(player: Player, time: float) -> None:
    """Play up to a time at least, and pause."""
    player.click("#play")
    end = monotonic() + 30
    while player.time < time:
        assert monotonic() < end
    player.click("#play")
    assert not player.playing


def errors(player: Player) -> list[float]:
    """Energy errors in the legend, in J."""
    digits = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")
    texts = (text.rpartition(": ")[2].removesuffix(" J") for text in player.texts("#legend li"))
    return [float(text.replace(" × 10", "e").translate(digits)) for text in texts]


def test_its_motion_has_the_bits_of_an_exported_program(
    player: Player, pages: Callable[[str], Path]
) -> None:
    show(player, pages("report"))
    play_until(player, 0.6)
    scene = load_scene("report")
    method = method_catalogue.load(METHOD)
    of = Simulation(method, scene.params, scene.y0, scene.duration, steps=1)
    space: dict[str, object] = {"__name__": "exported"}
    exec(exported_text(load("double_pendulum"), "python", of)[1], space)
    y, angles, values = [*space["START_STATE"]], [*space["START_ANGLES"]], [0.0] * 5
    end, derivatives = [0.0] * 6, [0.0] * 24
    for k in range(int(player.time / STEP + 1e-9)):
        space["step"](k * STEP, STEP, y, scene.params, derivatives, end)
        y = [*end]
        space["follow"](y, angles)
    space["row"](0.0, y, angles, scene.params, values)
    assert state(player) == values


def test_a_mass_is_dragged_and_the_motion_starts_there(
    player: Player, pages: Callable[[str], Path]
) -> None:
    from selenium.webdriver import ActionChains

    show(player, pages("report"))
    canvas = player.find("figure canvas")

    def masses() -> list[list[float]]:
        return json.loads(canvas.get_attribute("data-masses"))

    play_until(player, 0.5)
    x, y = masses()[1]
    middle = canvas.rect["width"] / 2, canvas.rect["height"] / 2
    action = ActionChains(player.driver, duration=20)
    action.move_to_element_with_offset(canvas, round(x - middle[0]), round(y - middle[1]))
    action.click_and_hold().move_by_offset(40, 20).move_by_offset(30, 10).perform()
    player.settle()
    assert np.hypot(*np.subtract(masses()[1], (x + 70, y + 30))) < 2.5
    assert state(player)[2:4] == [0.0, 0.0]
    assert not player.playing
    ActionChains(player.driver).release().perform()
    player.settle()
    assert player.playing


def test_its_address_keeps_start_parameters_and_methods(
    player: Player, pages: Callable[[str], Path]
) -> None:
    show(player, pages("report"))
    slider = player.find("#parameters input")
    player.driver.execute_script(
        "arguments[0].value = 2.5; arguments[0].dispatchEvent(new Event('input'))", slider
    )
    player.click("#compare")
    address, before = player.js("location.hash"), state(player)
    show(player, pages("report"), address)
    assert state(player) == before
    assert player.texts("#parameters output")[0] == "2.5 kg"
    assert len(player.texts("figure")) == 2
    show(player, pages("report"), "#nonsense")
    assert player.texts("#parameters output")[0] == "1 kg"


def test_a_method_of_order_one_shows_its_energy_error_beside_another(
    player: Player, pages: Callable[[str], Path]
) -> None:
    show(player, pages("report"))
    player.click("#compare")
    play_until(player, 1.0)
    accurate, euler = errors(player)
    assert accurate < 1e-5 < 1e-2 < euler


@pytest.mark.parametrize("scene", [FOUR_BAR, TOP], ids=["a closed loop", "a body in space"])
def test_constraints_and_bodies_in_space_are_integrated(
    scene: str, player: Player, pages: Callable[[str], Path]
) -> None:
    show(player, pages(scene))
    start = state(player)
    play_until(player, 0.5)
    assert state(player)[-1] == pytest.approx(start[-1], rel=1e-6)
    assert np.abs(np.subtract(state(player), start)).max() > 0.1
    assert len(np.unique(player.pixels("figure canvas").reshape(-1, 3), axis=0)) > 20


def test_a_motion_of_an_own_start_is_continued_from_there(
    player: Player, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.delitem(sys.modules, "ipykernel", raising=False)  # of another test
    motion = integrate(
        dp, (0, 2), {"theta1": "60 deg", "theta2": 0, "theta2_dot": 1.5}, {"m2": "300 g"}
    )
    page, path = motion.live(), Path(opened[0].removeprefix("file://"))
    assert path.read_text(encoding="utf-8") == page.html
    show(player, path)
    energy = dp.energy(0.0, motion.y[:, 0], dp.params(m2=0.3))
    assert state(player) == pytest.approx([*motion.y[:, 0], energy], abs=1e-14)
    assert player.texts("#parameters output")[1] == "0.3 kg"


def test_points_are_those_of_links_beside_the_masses(pages: Callable[[str], Path]) -> None:
    for scene, count in ((TOP, 4), ("report", 0)):
        text = pages(scene).read_text(encoding="utf-8")
        assert f'"points":{count},' in text


def test_a_step_that_is_too_large_is_reported_and_pages_are_small(
    player: Player, pages: Callable[[str], Path]
) -> None:
    assert pages("report").stat().st_size < 150_000
    settings = {"start": [1, 2, 30, -30], "parameters": [1, 1, 2, 2, 9.81], "runs": [["rk1", 0.5]]}
    show(player, pages("report"), f"#{json.dumps(settings)}")
    player.click("#play")
    end = monotonic() + 30
    while "no longer finite" not in player.find("#status").text:
        assert monotonic() < end
