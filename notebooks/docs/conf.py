"""Sphinx configuration: one site from READMEs, notebooks, gallery scripts and docstrings.

The source folder is the repository, so that links between READMEs hold on the site too. Markers
such as ``<!-- api: solvers -->`` are replaced by what the code itself states.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import os
import re
import sys
from collections.abc import Callable
from dataclasses import replace
from importlib.metadata import version as installed_version
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from matplotlib.figure import Figure
from sphinx.application import Sphinx
from sphinx_gallery.scrapers import figure_rst

from solvers.io.lazy import groups, homes

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))
os.environ["PYTHONPATH"] = str(ROOT)  # kernels of the notebooks import the same packages

project, author = "holonomic", "The holonomic developers"
version = release = installed_version("holonomic")
html_title = "holonomic"
copyright = author  # noqa: A001 - a name of Sphinx

extensions = [
    "myst_nb",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.viewcode",
    "sphinx_gallery.gen_gallery",
]
root_doc = "README"
include_patterns = [
    "README.md",
    "CHANGELOG.md",
    "derive/README.md",
    "derive/**/README.md",
    "solvers/README.md",
    "solvers/**/README.md",
    "notebooks/*.ipynb",
    "notebooks/docs/*.md",
    "notebooks/docs/gallery/*.rst",
]
exclude_patterns = [".*", "out", "build", "dist", "tests", "generated"]
suppress_warnings = ["config.cache", "mystnb.unknown_mime_type"]

myst_enable_extensions = ["colon_fence", "attrs_inline"]
myst_heading_anchors = 3
nb_execution_mode = "off"  # notebooks have their outputs, which a test compares
numpydoc_show_class_members = False
autodoc_typehints = "none"
autodoc_member_order = "bysource"
toc_object_entries_show_parents = "hide"


def figures(block: Any, variables: dict[str, Any], settings: dict[str, Any]) -> str:
    """Save the figures of a gallery script; they are made without pyplot."""
    paths = []
    for value in variables["example_globals"].values():
        if isinstance(value, Figure):
            paths.append(next(variables["image_path_iterator"]))
            value.savefig(paths[-1])
    return str(figure_rst(paths, settings["src_dir"]))


sphinx_gallery_conf = {
    "image_scrapers": (figures,),
    "examples_dirs": str(ROOT / "notebooks" / "gallery"),
    "gallery_dirs": "notebooks/docs/gallery",
    "filename_pattern": r"\.py$",
    "thumbnail_size": (720, 504),
    "show_memory": False,
    "min_reported_time": 1e9,
    "download_all_examples": False,
    "show_signature": False,
    "write_computation_times": False,
    "abort_on_example_error": True,
}

html_theme = "pydata_sphinx_theme"
html_context = {"default_mode": "auto"}
html_theme_options = {
    "show_prev_next": False,
    "secondary_sidebar_items": ["page-toc"],
    "navbar_end": ["theme-switcher"],
    "footer_end": [],
}
html_show_sourcelink = False
html_copy_source = False
templates_path = ["templates"]
html_static_path, html_css_files = ["static"], ["gallery.css"]
html_additional_pages = {"index": "index.html"}
html_math_renderer = "mathml"


def api(package: str) -> str:
    """Every public name of a package, documented from its docstring, in groups."""
    sections, modules = [], homes(ROOT / package / "__init__.pyi")
    titles = {names[0]: title for title, names in groups(package).items()}
    for name in (name for names in groups(package).values() for name in names):
        home = modules[name]
        if name in titles:
            sections.append(f"## {titles[name]}\n")
        value = getattr(importlib.import_module(home), name)
        is_described = callable(value)
        kind = "class" if isinstance(value, type) else "function" if is_described else "data"
        options = "" if is_described else "\n   :no-value:"
        if isinstance(value, type):  # with the members of bases that are not public themselves
            bases = (base for base in value.__mro__ if not base.__module__.startswith(package))
            foreign = ", ".join(sorted(base.__name__ for base in bases))
            options = f"\n   :members:\n   :inherited-members: {foreign}"
        path = f"{package if is_described else home}.{name}"
        sections.append(f"```{{eval-rst}}\n.. auto{kind}:: {path}{options}\n```\n")
    return "\n".join(sections)


def commands(_: str) -> str:
    """The help text of every subcommand."""
    from solvers.app.cli import COMMANDS, main

    sections = []
    for name in COMMANDS:
        text = io.StringIO()
        with contextlib.redirect_stdout(text), contextlib.suppress(SystemExit):
            main([name, "--help"])
        sections.append(f"## holonomic {name}\n\n```text\n{text.getvalue()}```\n")
    return "\n".join(sections)


def statuses(_: str) -> str:
    """The statuses of an integration."""
    from solvers import Status

    rows = "\n".join(f"| `{status.name}` | {status.value} |" for status in Status)
    return f"| status | meaning |\n|---|---|\n{rows}\n"


#: The page that integrates a motion, beside the front page.
LIVE_PAGE = "live.html"
MARKERS: dict[str, Callable[[str], str]] = {"api": api, "commands": commands, "statuses": statuses}


def replace_markers(app: Sphinx, document: str, source: list[str]) -> None:
    """Replace ``<!-- marker: argument -->`` in a page of the site."""
    markers = rf"<!-- ({'|'.join(MARKERS)}):? ?(\w*) -->"
    source[0] = re.sub(markers, lambda result: MARKERS[result[1]](result[2]), source[0])


def add_contents(app: Sphinx, document: str, source: list[str]) -> None:
    """Add the table of contents to the front page, which GitHub shows without it."""
    if document == root_doc:
        source[0] += (Path(__file__).parent / "contents.txt").read_text(encoding="utf-8")


def show_live_page(app: Sphinx, document: str, source: list[str]) -> None:
    """Show a motion that the page integrates on the front page, below the first paragraph."""
    if document == root_doc:
        frame = f'<iframe src="{LIVE_PAGE}" title="A double pendulum to drag"></iframe>'
        start = re.compile(r"^(!\[.*?\]\(.*?\)\n\n)(.*?\n\n)", re.MULTILINE | re.DOTALL)
        source[0] = start.sub(f"\\2```{{raw}} html\n{frame}\n```\n\n\\1", source[0], count=1)


def write_live_page(app: Sphinx, error: Exception | None) -> None:
    """Write the page that the front page frames."""
    from solvers import LivePage, load_scene

    if error is None and app.builder.format == "html":
        note = "Integrated in this page by generated code: drag a mass, change method and step."
        scene = replace(load_scene("report"), title="Double pendulum", note=note)
        LivePage(scene).write(Path(app.outdir) / LIVE_PAGE)


def mathml(translator: Any, node: nodes.math) -> None:
    """Set a formula as MathML, which browsers show without a script."""
    tree = tex2mathml(node.astext(), as_block=isinstance(node, nodes.math_block))
    translator.body.append(tree if isinstance(tree, str) else ElementTree.tostring(tree, "unicode"))
    raise nodes.SkipNode


def setup(app: Sphinx) -> None:
    """Connect the functions above."""
    app.add_html_math_renderer("mathml", (mathml, None), (mathml, None))
    app.connect("source-read", replace_markers)
    app.connect("source-read", add_contents)
    app.connect("source-read", show_live_page)
    app.connect("build-finished", write_live_page)
