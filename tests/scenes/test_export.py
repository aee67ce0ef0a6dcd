"""Exported motions: films with the right frames at the right speed, pictures, whole files."""

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from matplotlib.animation import FFMpegWriter
from matplotlib.figure import Figure
from numpy.testing import assert_allclose
from PIL import Image

from solvers import SceneResult, load_scene, run_scene
from solvers.app.cli import main
from solvers.player import film
from solvers.player.film import at, check_export, frame_times

BLUE = (0x00, 0x72, 0xB2)


@pytest.fixture(scope="module")
def swing() -> SceneResult:
    return run_scene(replace(load_scene("single"), duration=0.9))


def frames(path: Path) -> tuple[list[int], np.ndarray]:
    """Durations in ms, and pixels of shape (frames, rows, columns, 3)."""
    durations, images = [], []
    with Image.open(path) as images_of_film:
        for k in range(images_of_film.n_frames):  # type: ignore[attr-defined]
            images_of_film.seek(k)
            durations.append(images_of_film.info["duration"])
            images.append(np.asarray(images_of_film.convert("RGB")))
    return durations, np.array(images)


def bob(image: np.ndarray) -> np.ndarray:
    """Row and column of the mass, whose path is paler."""
    distance = np.abs(image.astype(int) - BLUE).max(axis=-1)
    return np.median(np.nonzero(distance < 12), axis=1)


@pytest.mark.long("other tests reach its code")
def test_a_film_has_exact_times_and_the_right_speed(swing: SceneResult, tmp_path: Path) -> None:
    path = swing.save(tmp_path / "new" / "swing.gif", speed=2.25)
    durations, images = frames(path)
    assert set(durations) == {40}
    times = np.arange(11) * 0.09
    assert len(images) == len(times)
    assert frame_times(0.9, 2.25) == pytest.approx(times)
    angle = np.interp(times, swing.t, swing.y[0])
    pixels = np.array([bob(image) for image in images])
    # one scale for both axes fits all frames
    rows = np.array([*np.stack([-2 * np.cos(angle) * -1, 0 * angle, 0 * angle + 1]).T,
                     *np.stack([2 * np.sin(angle), 0 * angle + 1, 0 * angle]).T])  # fmt: skip
    wanted = np.concatenate([pixels[:, 0], pixels[:, 1]])
    fit, *_ = np.linalg.lstsq(rows, wanted, rcond=None)
    assert np.abs(rows @ fit - wanted).max() < 1.5
    later = np.roll(rows, 1, axis=0)  # a frame too late
    assert np.abs(later @ np.linalg.lstsq(later, wanted, rcond=None)[0] - wanted).max() > 3
    assert [file.name for file in path.parent.iterdir()] == ["swing.gif"]


def test_films_alone_have_a_largest_number_of_frames() -> None:
    check_export(Path("motion.svg"), 1e6, 1.0)
    with pytest.raises(ValueError, match="frames, up to"):
        check_export(Path("motion.GIF"), 1e6, 1.0)


@pytest.mark.parametrize(("duration", "speed", "count"), [
    (2.0, 1.0, 51), (0.1, 1.0, 3), (0.3, 1.0, 8), (10.0, 4.0, 63), (0.7, 0.1, 176),
])  # fmt: skip
def test_the_last_frame_is_the_last_whole_one(duration: float, speed: float, count: int) -> None:
    times = frame_times(duration, speed)
    assert len(times) == count
    assert np.diff(times) == pytest.approx(speed / 25)
    assert duration - speed / 25 < times[-1] <= duration


def test_states_between_samples_are_smooth_and_the_end_stays(swing: SceneResult) -> None:
    coarse = replace(swing, t=swing.t[::5], y=swing.y[:, ::5])
    between = at(coarse.sampled_motions()[0], swing.t)
    assert np.abs(between.y[0] - swing.y[0]).max() < 1e-8
    assert np.abs(np.interp(swing.t, coarse.t, coarse.y[0]) - swing.y[0]).max() > 1e-6
    assert at(swing.sampled_motions()[0], np.array([5.0])).y[:, 0] == pytest.approx(swing.y[:, -1])


@pytest.mark.long("other tests reach its code")
@pytest.mark.parametrize("suffix", [".svg", ".pdf"])
def test_pictures_for_slides(suffix: str, swing: SceneResult, tmp_path: Path) -> None:
    path = swing.save(tmp_path / f"swing{suffix}", beside=[swing])
    data = path.read_bytes()
    assert data.startswith({".svg": b"<?xml", ".pdf": b"%PDF"}[suffix])
    if suffix == ".svg":
        assert swing.save(path, beside=[swing]).read_bytes() == data
        text = data.decode()
        assert "t = 0 to 0.9 s, every 0.11" in text
        assert "<image" not in text
        rods = re.findall(r"<path [^>]*stroke: #4a5259", text)
        assert len(rods) >= 2 * film.INSTANTS


@pytest.mark.parametrize(("speed", "clock"), [
    (0.1, ["0.100", "0.400", "0.850"]), (0.3, ["0.10", "0.40", "0.85"]),
])  # fmt: skip
def test_a_film_shows_its_time_and_the_path_of_its_last_two_seconds(
    swing: SceneResult, speed: float, clock: list[str], tmp_path: Path
) -> None:
    """Against the positions of the bob at the times of the samples and of each frame.

    A frame lasts 0.04 s of the film: its time has the digits in which the next one differs.
    """

    class Frames:
        """The time and the longest line of each frame, instead of a file."""

        def __init__(self) -> None:
            self.paths: list[np.ndarray] = []
            self.clock: list[str] = []

        def setup(self, figure: Figure, *_: object) -> None:
            self.axes, self.figure = figure.axes[0], figure

        def grab_frame(self) -> None:
            self.clock.append(self.figure.get_supxlabel())
            self.paths.append(max((line.get_xydata() for line in self.axes.lines), key=len))

        def finish(self) -> None:
            pass

    writer, times = Frames(), np.array([0.1, 0.4, 0.85])
    film._write_film(writer, tmp_path, swing.sampled_motions(), times, speed)  # type: ignore[arg-type]
    assert writer.clock == [f"t = {time} s" for time in clock]
    for time, path in zip(times, writer.paths, strict=True):
        shown = (swing.t >= time - 2 * speed) & (swing.t <= time)
        angle = np.append(swing.y[0, shown], np.interp(time, swing.t, swing.y[0]))
        assert_allclose(path, 2 * np.transpose([np.sin(angle), -np.cos(angle)]), atol=1e-3)


def test_an_absent_mass_is_left_out() -> None:
    scene = replace(load_scene("one_bob"), duration=0.2, beside=())
    result = run_scene(scene)
    assert np.isnan(result.y).any()
    moved = at(result.sampled_motions()[0], np.array([0.05, 0.1]))
    assert np.isnan(moved.y).all(axis=1).tolist() == np.isnan(result.y).all(axis=1).tolist()
    assert film._Panel(Figure().subplots(), result.sampled_motions()[0], moved.t).masses.shape == (
        1,
        2,
        2,
    )


@pytest.mark.parametrize("name", ["rest", "spring"])
def test_motions_along_a_line_have_room_beside_it(name: str) -> None:
    result = run_scene(replace(load_scene(name), duration=0.2, beside=()))
    figure, (panel,) = film._figure(result.sampled_motions(), result.t[:1])
    for low, high in (panel.axes.get_xlim(), panel.axes.get_ylim()):
        assert high - low > 0.5 * panel.size
    assert high - low == pytest.approx(1.12 * panel.size)  # the height, with margins of 6 %
    figure.draw_without_rendering()
    boxes = [tick.label1.get_window_extent() for tick in panel.axes.xaxis.get_major_ticks()]
    assert all(a.x1 < b.x0 for a, b in pairwise(boxes))


def test_a_failed_export_leaves_the_old_file_and_nothing_else(
    swing: SceneResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "swing.gif"
    path.write_bytes(b"old")

    def stop(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    for target, name in ((os, "replace"), (film._Panel, "draw")):
        with monkeypatch.context() as patch:
            patch.setattr(target, name, stop)
            with pytest.raises(OSError, match="No space"):
                replace(swing, t=swing.t[:9], y=swing.y[:, :9]).save(path)
        assert [(file.name, file.read_bytes()) for file in tmp_path.iterdir()] == [
            ("swing.gif", b"old")
        ]


@pytest.mark.parametrize(("name", "speed", "words"), [
    ("a.mpg", 1.0, r"'a.mpg': its name must end in one of .gif, .mp4, .pdf"),
    ("a", 1.0, "must end in one of"),
    ("a.gif", 0.0, "speed = 0.0 must be positive"),
    ("a.gif", 0.001, r"has 22501 frames, up to 3000 .* speed to 0.0075 or more"),
])  # fmt: skip
def test_wrong_exports_are_refused(name: str, speed: float, words: str, swing: SceneResult) -> None:
    with pytest.raises(ValueError, match=words):
        swing.save(name, speed=speed)


def test_mp4_without_ffmpeg_names_the_way_out(
    swing: SceneResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(FFMpegWriter, "isAvailable", classmethod(lambda cls: False))
    with pytest.raises(ValueError, match=r"ffmpeg, which is not found: install it, .*or export a"):
        swing.save("a.mp4")


@pytest.mark.skipif(not shutil.which("ffmpeg"), reason="needs ffmpeg")
def test_an_mp4_has_the_same_frames(swing: SceneResult, tmp_path: Path) -> None:
    path = swing.save(tmp_path / "swing.mp4")
    command = ["ffmpeg", "-i", str(path), "-f", "null", "-"]
    shown = subprocess.run(command, capture_output=True, text=True, check=True).stderr
    assert "25 fps" in shown
    assert re.findall(r"frame= *(\d+)", shown)[-1] == "23"


def test_the_command_exports_one_scene(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["run", "single", "--export", "single.svg"]) == 0
    assert "out/single.html, single.svg" in capsys.readouterr().out
    assert (tmp_path / "single.svg").exists()
    refused: Callable[..., int] = lambda *rest: main(["run", "single", *rest])  # noqa: E731
    assert refused("report", "--export", "a.gif") == 2
    assert "--export a.gif is one file, but 2 scenes run: run one" in capsys.readouterr().err
    assert refused("--export", "a.gif", "--speed", "1e-3") == 2
    assert "increase speed" in capsys.readouterr().err
    assert not (tmp_path / "a.gif").exists()
