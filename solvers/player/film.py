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

from solvers.equations.number_checks import positive
from solvers.io.atomic_write import write_text
from solvers.io.figures import FORMATS, colours, panels, save
from solvers.player.motion_plots import draw_link, label_axes, plain
from solvers.player.sampled_motion import SampledMotion, links_and_points, mass_positions, projected
from solvers.player.track import Array

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


def write_motions(motions: Sequence[SampledMotion], path: Path, speed: float = 1.0) -> Path:
    """Write motions side by side as a film or a picture, by the suffix of the file's name.

    `check_export` describes what is refused; an existing file is replaced.
    """
    duration = max(float(one.t[-1] - one.t[0]) for one in motions)
    check_export(path, duration, speed)
    suffix = path.suffix.lower()
    if suffix in FORMATS:
        save(_instants(motions), path)
        return path
    times = motions[0].t[0] + frame_times(duration, speed)
    with TemporaryDirectory() as folder:
        film = Path(folder) / f"film{suffix}"
        _write_film(FILMS[suffix](), film, motions, times, speed)
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


def at(motion: SampledMotion, times: Array) -> SampledMotion:
    """The motion at other times, by cubic polynomials between samples; it ends as it ended."""
    times = np.clip(times, motion.t[0], motion.t[-1])
    y, n = np.full((len(motion.y), len(times)), np.nan), len(motion.y) // 2
    for k in np.flatnonzero(np.isfinite(motion.y[:n]).all(axis=1)).tolist():
        spline = scipy.interpolate.CubicHermiteSpline(motion.t, motion.y[k], motion.y[k + n])
        y[k], y[k + n] = spline(times), spline(times, 1)
    return replace(motion, t=times, y=y, energy=None)


class _Panel:
    """The picture of one motion at given times in s."""

    def __init__(self, axes: Axes, motion: SampledMotion, times: Array) -> None:
        self.axes, self.t, self.sample_times = axes, times, motion.t
        self.paths = projected(mass_positions(motion))
        chosen = at(motion, times)
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
        for mass, colour in zip(self.masses, colours(len(self.masses)), strict=True):
            self.axes.plot(*mass[:, k], "o", color=colour, markersize=7, alpha=alpha)

    def draw_paths(self, k: int, duration: float) -> None:
        """Paths of the masses in the time before a time."""
        start = self.t[k] - duration
        samples = (self.sample_times >= start) & (self.sample_times <= self.t[k])
        own = colours(len(self.masses))
        for path, mass, colour in zip(self.paths, self.masses, own, strict=True):
            x, y = np.column_stack([path[:, samples], mass[:, k]])
            self.axes.plot(x, y, color=colour, linewidth=1.2, alpha=0.6, zorder=1)


def _figure(motions: Sequence[SampledMotion], times: Array) -> tuple[Figure, list[_Panel]]:
    """Panels side by side, with the same limits, of motions at given times."""
    drawn = [_Panel(Figure().subplots(), motion, times) for motion in motions]
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
    size = (2 * round(HEIGHT * ratio * PIXELS / 2) / PIXELS * len(motions), HEIGHT)
    figure, axes = panels(plain(motions[0].title), columns=len(motions), size=size)
    for panel, own, motion in zip(drawn, axes, motions, strict=True):
        panel.axes = own
        label_axes(own, "path", [motion])
        own.set(xlim=(left, right), ylim=(bottom, top))
        own.set_aspect("equal", adjustable="box")
        own.spines[["top", "right"]].set_visible(False)
        own.xaxis.set_major_locator(MaxNLocator(6))
        own.autoscale(False)
        if len(motions) > 1:
            own.set_title(plain(motion.label), fontsize="medium")
    return figure, drawn


def _instants(motions: Sequence[SampledMotion]) -> Figure:
    """Paths, and links at instants that are the darker the later they are."""
    begin, end = motions[0].t[0], max(float(one.t[-1]) for one in motions)
    times = np.linspace(begin, end, INSTANTS)
    figure, drawn = _figure(motions, times)
    for panel in drawn:
        panel.draw_paths(INSTANTS - 1, end - begin)
        for k in range(INSTANTS):
            panel.draw(k, alpha=max(((k + 1) / INSTANTS) ** 2, 0.08))
    _label(figure, f"t = {begin:.4g} to {end:.4g} s, every {times[1] - times[0]:.3g} s")
    return figure


def _label(figure: Figure, text: str) -> Text:
    """A text below the panels."""
    return figure.supxlabel(text, x=0.99, ha="right", fontsize="small", color="#444444")


def _write_film(
    writer: AbstractMovieWriter,
    path: Path,
    motions: Sequence[SampledMotion],
    times: Array,
    speed: float,
) -> None:
    figure, drawn = _figure(motions, times)
    decimals = 2 if speed > 0.2 else 3
    clock = _label(figure, f"t = {times[0]:.{decimals}f} s")
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
