"""Motions as files for slides: GIF and MP4 films, and vector pictures at several instants."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from math import floor
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import scipy
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator

from solvers.equations.arguments import checked
from solvers.equations.quantities import positive
from solvers.integration.accuracy.motion import Array
from solvers.io.atomic_write import write_text
from solvers.io.figures import COLOURS, FORMATS, panels, save
from solvers.scenes.geometry import links_and_points, mass_positions, projected
from solvers.scenes.plots import label_axes, plain
from solvers.scenes.run import SceneResult
from solvers.scenes.shapes import draw_link

#: Frames a second of a film, of 40 ms: a GIF counts in hundredths of a second, and programs show
#: frames of less than 20 ms more slowly. Also the most frames.
RATE, MOST_FRAMES = 25, 3000
#: Duration of traces in seconds of the film, and instants of a vector picture.
TRACE, INSTANTS = 2.0, 9
#: Height of a picture and pixels per inch, and the narrowest and widest panel for this height.
HEIGHT, PIXELS, NARROW, WIDE = 4.8, 100, 0.9, 1.8
#: Colour of links.
DARK = "#4a5259"
FILMS: dict[str, Callable[[], AbstractMovieWriter]] = {
    ".gif": lambda: PillowWriter(fps=RATE),
    ".mp4": lambda: FFMpegWriter(fps=RATE, codec="h264", extra_args=["-pix_fmt", "yuv420p"]),
}
SUFFIXES = (*FILMS, *FORMATS)


@checked
def export_motion(
    result: SceneResult | Sequence[SceneResult], path: str | Path, *, speed: float = 1.0
) -> Path:
    """Write a motion as a film or as a picture for slides, by the suffix of the file's name.

    Parameters
    ----------
    result : SceneResult or sequence of SceneResult
        The motion, or several motions side by side.
    path : str or Path
        The file: ``.gif`` or ``.mp4`` is a film of 25 frames a second, for which MP4 needs the
        program ffmpeg; ``.svg``, ``.pdf`` or ``.png`` is a picture of the paths with the links at
        nine instants. Missing folders are created, and an existing file is replaced.
    speed : float, optional
        Seconds of the motion in a second of the film.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ValueError
        When the name ends in another suffix, ffmpeg is missing, or the film is too long.
    OSError
        When the file cannot be written; an existing file is unchanged.

    Examples
    --------
    >>> from solvers import export_motion, run_scene
    >>> print(export_motion(run_scene("single"), "single.svg"))
    single.svg
    """
    path, results = Path(path), [result] if isinstance(result, SceneResult) else [*result]
    if not results:
        raise ValueError("result = [] must hold one motion or more")
    duration = max(float(one.t[-1]) for one in results)
    check_export(path, duration, speed)
    suffix = path.suffix.lower()
    if suffix in FORMATS:
        save(_instants(results), path)
        return path
    times = frame_times(duration, speed)
    with TemporaryDirectory() as folder:
        film = Path(folder) / f"film{suffix}"
        _write_film(FILMS[suffix](), film, results, times, speed)
        return write_text(path, film.read_bytes())


def check_export(path: Path, duration: float, speed: float) -> None:
    """Raise `ValueError` if a motion of a duration in s cannot be written to a file."""
    suffix = path.suffix.lower()
    positive("speed", speed)
    if suffix not in SUFFIXES:
        known = ", ".join(SUFFIXES)
        raise ValueError(f"export {str(path)!r}: its name must end in one of {known}")
    if suffix == ".mp4" and not FFMpegWriter.isAvailable():
        raise ValueError(
            f"export {str(path)!r} needs the program ffmpeg, which is not found: install it, "
            "such as with apt-get install ffmpeg, brew install ffmpeg or winget install ffmpeg, "
            "or export a .gif"
        )
    if suffix in FILMS:
        frame_times(duration, speed)


def frame_times(duration: float, speed: float) -> Array:
    """Times of the frames in s of the motion; the last is the last whole frame."""
    frames = floor(duration * RATE / speed * (1 + 1e-12)) + 1
    if frames > MOST_FRAMES:
        least = duration * RATE / (MOST_FRAMES - 1)
        raise ValueError(
            f"a film of {duration:g} s at speed {speed:g} has {frames} frames, up to "
            f"{MOST_FRAMES} are written: increase speed to {least:.2g} or more"
        )
    return np.minimum(np.arange(frames) * speed / RATE, duration)


def at(result: SceneResult, times: Array) -> SceneResult:
    """The motion at other times, by cubic polynomials between samples; it ends as it ended."""
    times = np.clip(times, result.t[0], result.t[-1])
    y, n = np.full((len(result.y), len(times)), np.nan), len(result.y) // 2
    for k in np.flatnonzero(np.isfinite(result.y[:n]).all(axis=1)).tolist():
        spline = scipy.interpolate.CubicHermiteSpline(result.t, result.y[k], result.y[k + n])
        y[k], y[k + n] = spline(times), spline(times, 1)
    return replace(result, t=times, y=y, energy=None)


class _Panel:
    """The picture of one motion at given times in s."""

    def __init__(self, axes: Axes, result: SceneResult, times: Array) -> None:
        self.axes, self.t, self.sample_times = axes, times, result.t
        self.paths = projected(mass_positions(result))
        chosen = at(result, times)
        self.links, points = links_and_points(chosen)
        self.masses = projected(mass_positions(chosen))
        self.points = projected(points)
        used = {number for kind, ends in self.links if kind != "rail" for number in ends}
        count = len(self.masses)
        visible = [*self.paths, *(p for k, p in enumerate(self.points, count) if k in used)]
        if not len(points):  # the pivot, too
            visible.append(np.zeros((2, 1)))
        together = np.concatenate(visible, axis=1)
        self.low, self.high = together.min(axis=1), together.max(axis=1)
        self.size = float(np.max(self.high - self.low)) or 1.0

    def draw(self, k: int, alpha: float = 1.0) -> None:
        """Links and masses at a time."""
        # the last place is the origin, -1
        parts = [self.masses[..., k], self.points[..., k], np.zeros((1, 2))]
        places = np.concatenate(parts)
        for kind, numbers in self.links:
            draw_link(self.axes, kind, places[[*numbers]], self.size, DARK, alpha)
        lines = [ends for kind, ends in self.links if kind in ("rod", "thread", "spring")]
        joints = [number for ends in lines for number in ends if number >= len(self.masses)]
        self.axes.plot(*places[joints].T, "o", color=DARK, markersize=3.5, alpha=alpha)
        for mass, colour in zip(self.masses, _colours(len(self.masses)), strict=True):
            self.axes.plot(*mass[:, k], "o", color=colour, markersize=7, alpha=alpha)

    def draw_paths(self, k: int, duration: float) -> None:
        """Paths of the masses in the time before a time."""
        start = self.t[k] - duration
        samples = (self.sample_times >= start) & (self.sample_times <= self.t[k])
        colours = _colours(len(self.masses))
        for path, mass, colour in zip(self.paths, self.masses, colours, strict=True):
            x, y = np.column_stack([path[:, samples], mass[:, k]])
            self.axes.plot(x, y, color=colour, linewidth=1.2, alpha=0.6, zorder=1)


def _colours(count: int) -> list[str]:
    return [COLOURS[k % len(COLOURS)] for k in range(count)]


def _figure(results: Sequence[SceneResult], times: Array) -> tuple[Figure, list[_Panel]]:
    """Panels side by side, with the same limits, of motions at given times."""
    scene = results[0].scene
    drawn = [_Panel(Figure().subplots(), result, times) for result in results]
    low = np.min([panel.low for panel in drawn], axis=0)
    high = np.max([panel.high for panel in drawn], axis=0)
    margin = 0.06 * float((high - low).max()) or 1.0
    width, height = high - low + 2 * margin
    # of a motion along a line, room beside it
    width, height = max(width, NARROW * height), max(height, width / WIDE)
    (left, right), (bottom, top) = (
        (middle - side / 2, middle + side / 2)
        for middle, side in zip((low + high) / 2, (width, height), strict=True)
    )
    ratio = width / height
    # even numbers of pixels, as MP4 requires
    size = (2 * round(HEIGHT * ratio * PIXELS / 2) / PIXELS * len(results), HEIGHT)
    figure, axes = panels(plain(scene.title), columns=len(results), size=size)
    for panel, own, result in zip(drawn, axes, results, strict=True):
        panel.axes = own
        label_axes(own, "path", [result])
        own.set(xlim=(left, right), ylim=(bottom, top))
        own.set_aspect("equal", adjustable="box")
        own.spines[["top", "right"]].set_visible(False)
        own.xaxis.set_major_locator(MaxNLocator(6))
        own.autoscale(False)
        if len(results) > 1:
            own.set_title(plain(result.scene.label), fontsize="medium")
    return figure, drawn


def _instants(results: Sequence[SceneResult]) -> Figure:
    """Paths, and links at instants that are the darker the later they are."""
    duration = max(float(one.t[-1]) for one in results)
    times = np.linspace(0, duration, INSTANTS)
    figure, drawn = _figure(results, times)
    for panel in drawn:
        panel.draw_paths(INSTANTS - 1, duration)
        for k in range(INSTANTS):
            panel.draw(k, alpha=max(((k + 1) / INSTANTS) ** 2, 0.08))
    _label(figure, f"t = 0 to {duration:.4g} s, every {times[1]:.3g} s")
    return figure


def _label(figure: Figure, text: str) -> Text:
    """A text below the panels."""
    return figure.supxlabel(text, x=0.99, ha="right", fontsize="small", color="#444444")


def _write_film(
    writer: AbstractMovieWriter,
    path: Path,
    results: Sequence[SceneResult],
    times: Array,
    speed: float,
) -> None:
    figure, drawn = _figure(results, times)
    decimals = 2 if speed > 0.2 else 3
    clock = _label(figure, f"t = {0:.{decimals}f} s")
    figure.draw_without_rendering()
    figure.set_layout_engine(None)  # else labels would move from frame to frame
    writer.setup(figure, str(path), PIXELS)
    try:
        for k, time in enumerate(times):
            with _removed_after(drawn):
                clock.set_text(f"t = {time:.{decimals}f} s")
                for panel in drawn:
                    panel.draw_paths(k, TRACE * speed)
                    panel.draw(k)
                writer.grab_frame()
    except BaseException:
        with suppress(Exception):  # end the program that writes, and report the first mistake
            writer.finish()
        raise
    writer.finish()


@contextmanager
def _removed_after(drawn: Sequence[_Panel]) -> Iterator[None]:
    """Remove the lines and areas that are drawn in this context."""
    before = [{*panel.axes.get_children()} for panel in drawn]
    yield
    for panel, kept in zip(drawn, before, strict=True):
        for artist in panel.axes.get_children():
            if artist not in kept:
                artist.remove()
