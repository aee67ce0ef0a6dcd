"""Arguments, output and optional packages that several commands share."""

import json
from argparse import Action, ArgumentParser, HelpFormatter, Namespace
from collections.abc import Callable, Iterable, Sequence
from importlib import import_module
from pathlib import Path
from shutil import get_terminal_size
from textwrap import TextWrapper
from types import ModuleType
from typing import TYPE_CHECKING, Any
from unicodedata import normalize

from solvers.io.toml_input import names, read_table

if TYPE_CHECKING:
    from solvers.scenes.scene import Scene

#: The folder of the folders of scenes and sweeps.
FILES = Path(__file__).parents[2]
#: Completion of a folder's name, for shtab.
FOLDER = {"bash": "_shtab_compgen_dirs", "zsh": "_files -/"}


class Formatter(HelpFormatter):
    """Wraps paragraphs to the width of the terminal, and keeps indented lines as they are."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return "\n".join(
            line if line.startswith(" ") else super(Formatter, self)._fill_text(line, width, indent)
            for line in text.splitlines()
        )


def shipped(kind: str) -> tuple[str, ...]:
    """Names of the ``scenes`` or ``sweeps`` that ship, without loading their readers."""
    return names(FILES / kind / "files")


def add_list(parser: ArgumentParser, kind: str, key: str) -> None:
    """List what ships below the help text, each file with the first sentence of a key."""

    def listing() -> str:
        width, names = get_terminal_size().columns, shipped(kind)
        margin = max(map(len, names)) + 4
        lines = [f"{kind}:"]
        for name in names:
            text = read_table(FILES / kind / "files" / f"{name}.toml", "")[key]
            sentence = text.partition(". ")[0].rstrip(".")
            wrapper = TextWrapper(width, subsequent_indent=" " * margin)
            wrapper.initial_indent = f"  {name}".ljust(margin)
            lines.append(wrapper.fill(sentence))
        return "\n".join(lines)

    setattr(parser, "listing", listing)  # noqa: B010  the attribute is that of our parser


def complete_with(action: Action, kind: str, words: Sequence[str]) -> None:
    """Let shells complete an argument with these words, and with files."""
    function, text = f"_holonomic_{kind}", " ".join(words)
    shell = f'{function}() {{ compgen -W "{text}" -- "$1"; compgen -f -- "$1"; }}'
    completion = {"bash": function, "zsh": f"({text})", "preamble": {"bash": shell}}
    setattr(action, "complete", completion)  # noqa: B010  the attribute is shtab's


def add_scenes(parser: ArgumentParser, default: Sequence[str]) -> None:
    """Add the argument SCENE, which can be repeated, and the list of scenes."""
    meaning = f"a name, or a file that ends in .toml (default: {', '.join(default)})"
    action = parser.add_argument("scenes", nargs="*", metavar="SCENE", help=meaning)
    complete_with(action, "scenes", shipped("scenes"))
    add_list(parser, "scenes", "note")


def add_output(parser: ArgumentParser, contents: str, default: str = "out") -> None:
    """Add the option ``--output`` for a folder of plots."""
    meaning = f"folder for {contents} (default: {default})"
    action = parser.add_argument(
        "--output", type=Path, metavar="DIR", default=default, help=meaning
    )
    setattr(action, "complete", FOLDER)  # noqa: B010  the attribute is shtab's
    parser.set_defaults(draws=True)


def add_json(parser: ArgumentParser) -> None:
    """Add the option ``--json``."""
    parser.add_argument("--json", action="store_true", help="print JSON instead of text")


def add_examples(parser: ArgumentParser, *examples: str) -> None:
    """Add examples below the help text."""
    title = "examples" if examples[1:] else "example"
    parser.epilog = f"{title}:\n" + "\n".join(f"  {line}" for line in examples)


def selected_scenes(
    arguments: Namespace,
    default: Sequence[str],
    files: "Callable[[Scene], Iterable[str]]" = lambda scene: [scene.name],
) -> "list[Scene]":
    """The requested scenes, each once, or the default ones; the output folder is created.

    `ValueError` where two of them would write the same one of their `files`.
    """
    from solvers.app.modules import load
    from solvers.scenes.scene_reading import find

    scenes = [find(name, load) for name in dict.fromkeys(arguments.scenes or default)]
    writers: dict[str, Scene] = {}
    for scene in scenes:
        for file in files(scene):
            # some file systems do not distinguish cases, or forms of accented letters
            other = writers.setdefault(normalize("NFC", file).casefold(), scene)
            if other is not scene:
                raise ValueError(
                    f"the scenes {other.name!r} and {scene.name!r} would both write {file}: rename "
                    "one of them, or run them with a different --output each"
                )
    arguments.output.mkdir(parents=True, exist_ok=True)
    return scenes


def print_json(results: Any) -> None:
    """Print results as JSON; numbers that are not finite become null."""
    from solvers.io.exports import jsonable

    print(json.dumps(jsonable(results), indent=2))  # in ASCII: valid in every encoding


def required_package(name: str, extra: str) -> ModuleType:
    """A package; `OSError` names the extra that installs it."""
    try:
        return import_module(name)
    except ImportError:
        text = f"{name} is not installed: pip install 'holonomic[{extra}]'"
        raise OSError(text) from None
