"""A folder for Matplotlib's settings and fonts where its own cannot be used."""

import os
import sys
from errno import EACCES
from pathlib import Path

from solvers.io.build_cache import NoPlaceError, temporary_folder

#: The variable that names the folder.
VARIABLE = "MPLCONFIGDIR"


def provide_matplotlib_folder() -> None:
    """Set `VARIABLE` to a temporary folder where Matplotlib would print warnings, or fail.

    Raises
    ------
    NoPlaceError
        When there is no folder that can be written to.
    """
    reasons = [] if os.environ.get(VARIABLE) else [*map(_obstacle, _own_folders())]
    if any(reasons):
        hint = f"set {VARIABLE} to a folder that can be written to"
        try:
            os.environ[VARIABLE] = str(temporary_folder())
        except NoPlaceError as error:
            causes = "; ".join([*filter(None, dict.fromkeys(reasons)), str(error)])
            raise NoPlaceError(f"Matplotlib needs a folder ({causes}): {hint}") from error


def _own_folders() -> list[Path]:
    """The folders that Matplotlib uses by default."""
    home = Path(os.path.expanduser("~"))
    if sys.platform == "darwin":
        return [home / ".matplotlib"]
    roots = {"XDG_CONFIG_HOME": ".config", "XDG_CACHE_HOME": ".cache"}
    return [
        Path(os.environ.get(name) or home / folder) / "matplotlib" for name, folder in roots.items()
    ]


def _obstacle(folder: Path) -> str:
    """The reason why a folder cannot be written to; empty if it can."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK):
            raise PermissionError(EACCES, os.strerror(EACCES))
    except OSError as error:
        return f"{folder}: {error.strerror}"
    return ""
