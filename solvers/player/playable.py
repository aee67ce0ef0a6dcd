"""Results that show themselves: as a page that plays, a film, or plots."""

import sys
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from solvers.io.argument_types import check_type
from solvers.io.suggestion import shortened
from solvers.player.sampled_motion import SampledMotion

if TYPE_CHECKING:
    from solvers import LivePage
    from solvers.player.player_page import Page


class Playable(ABC):
    """A result whose motions can be shown, side by side with those of others."""

    @abstractmethod
    def sampled_motions(self) -> list[SampledMotion]:
        """The motions at times that show them smoothly."""

    def play(self, beside: Sequence["Playable"] = ()) -> "Page":
        """The page that plays the motions: opened in a browser, in notebooks displayed.

        Parameters
        ----------
        beside : sequence of Solution, Ensemble or SceneResult, optional
            Results to show side by side with this one.
        """
        page = _page(_together(self, beside))
        _open(page)
        return page

    def live(self) -> "LivePage":
        """The page that integrates from the start of the first motion while it is open.

        Masses are dragged and parameters changed there, see `solvers.LivePage`. The page is opened
        in a browser, in notebooks displayed.

        Raises
        ------
        ValueError
            If a mass of the motion is absent.
        """
        from solvers import LivePage  # its code is generated, by a package above this one

        page = LivePage(self)
        _open(page)
        return page

    def save(
        self, path: str | Path, *, speed: float = 1.0, beside: Sequence["Playable"] = ()
    ) -> Path:
        """Write the motions to a file, by the suffix of its name.

        Parameters
        ----------
        path : str or Path
            The file: ``.html`` is a page that plays the motions; ``.gif`` or ``.mp4`` is a film of
            25 frames a second, for which MP4 needs the program ffmpeg; ``.svg``, ``.pdf`` or
            ``.png`` is a picture of the paths with the links at nine instants. Missing folders are
            created, and an existing file is replaced.
        speed : float, optional
            Seconds of the motion in a second of the film.
        beside : sequence of Solution, Ensemble or SceneResult, optional
            Results to show side by side with this one.

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
        >>> from solvers import run_scene
        >>> print(run_scene("single").save("single.svg"))
        single.svg
        """
        check_type("path", path, str | Path, "a path")
        path, motions = Path(path), _together(self, beside)
        if path.suffix.lower() == ".html":
            _page(motions).write(path)
            return path
        from solvers.player.film import write_motions

        return write_motions(motions, path, speed)

    def plot(self, beside: Sequence["Playable"] = ()) -> Any:
        """A Matplotlib figure of coordinates, velocities, paths and the energy error.

        Parameters
        ----------
        beside : sequence of Solution, Ensemble or SceneResult, optional
            Results to show in the same panels.
        """
        from solvers.player.motion_plots import figure

        return figure(_together(self, beside))

    def _repr_html_(self) -> str:
        return _page(self.sampled_motions())._repr_html_()


def _open(page: "Page | LivePage") -> None:
    """Open a page in a browser, unless a notebook displays it."""
    if "ipykernel" not in sys.modules:
        import webbrowser
        from tempfile import mkdtemp

        path = Path(mkdtemp(prefix="holonomic-")) / "motion.html"
        page.write(path)
        webbrowser.open(path.as_uri())


def _together(first: Playable, beside: Sequence[Playable]) -> list[SampledMotion]:
    """All motions, of which the first has the notes of all."""
    if not isinstance(beside, list | tuple) or not all(isinstance(x, Playable) for x in beside):
        raise ValueError(f"beside = {shortened(beside)} must be a list of results with motions")
    main, *others = (motion for one in (first, *beside) for motion in one.sampled_motions())
    notes = dict.fromkeys(one.note for one in (main, *others) if one.note)
    motions = (replace(main, note=" ".join(notes)), *others)
    labels = [one.label for one in motions]
    if len({*labels}) == len(labels):
        return [*motions]
    return [replace(one, label=f"{k}: {one.label}") for k, one in enumerate(motions, 1)]


def _page(motions: Sequence[SampledMotion]) -> "Page":
    from solvers.player.player_page import Page
    from solvers.player.sampled_motion import tracks

    return Page(motions[0].title, motions[0].note, tracks(motions))
