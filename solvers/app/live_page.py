"""Pages that integrate a scene in the browser, with generated code."""

from html import escape
from os import PathLike, fspath
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

import numpy as np

from solvers.app.modules import load, specialiser, system_of
from solvers.equations.module import has_constraints, links
from solvers.io.atomic_write import write_text
from solvers.io.figure_names import plain_symbol
from solvers.io.html_page import html_page
from solvers.player.playable import Playable
from solvers.player.player_page import VIEW, as_json, source, style
from solvers.player.sampled_motion import SampledMotion, links_and_points
from solvers.runge_kutta import method_catalogue
from solvers.scenes.scene import Scene
from solvers.scenes.scene_reading import find
from solvers.scenes.scene_run import run_scene

if TYPE_CHECKING:
    from derive.codegen.export.exported_system import ExportedSystem

#: Methods that the page offers, from that of lowest order on.
METHODS = ("rk1", "midpoint", "rk3", "rk4", "dp54", "verner853")
METHOD, STEP = "rk4", 0.002
#: The view shows this part of the motion, in s at most.
VIEWED = 20.0


class LivePage:
    """A page that integrates a motion while it is open; notebooks display it.

    Masses are dragged, parameters, methods and step sizes change while the motion runs, and its
    energy error is shown. The page needs no network: the generated functions are in it. Inputs are
    parameters there; a controller is not part of it.

    Parameters
    ----------
    motion : Solution, SceneResult, Scene, str or path
        A motion, from whose start the page integrates; or a scene, the name of one that ships, or
        the path of a TOML file.

    Raises
    ------
    ValueError
        If there is no such scene, or a mass of it is absent.

    Examples
    --------
    >>> from solvers import LivePage
    >>> page = LivePage("report")
    >>> len(page.html) < 150_000
    True
    """

    def __init__(self, motion: Playable | Scene | str | PathLike[str]) -> None:
        if not isinstance(motion, Playable):
            scene = motion if isinstance(motion, Scene) else find(fspath(motion), load)
            motion = run_scene(scene, specialiser)
        self.html = _html(motion.sampled_motions()[0])

    def write(self, path: Path) -> None:
        """Write the file atomically; missing folders are created, an existing file is replaced."""
        write_text(path, self.html)

    def _repr_html_(self) -> str:
        attributes = 'width="100%" height="900" style="border: 0"'
        return f'<iframe {attributes} srcdoc="{escape(self.html)}"></iframe>'


def _html(motion: SampledMotion) -> str:
    from derive import Derivation, reduced
    from derive.codegen.export.exported_system import ExportedSystem

    system = system_of(motion.module)
    exported = ExportedSystem(Derivation(reduced(system)))
    header = f'<h1>{escape(motion.title)}</h1>\n<p id="note">{escape(motion.note)}</p>'
    main = Template(source("live.html")).substitute(system=_values(motion, exported))
    body = f"<header>\n{header}\n</header>\n<main>\n{main}</main>"
    scripts = [_functions(motion, exported), *map(source, ("live_runs.js", *VIEW, "live.js"))]
    return html_page(motion.title, body, f"{style()}\n{source('live.css')}", "\n".join(scripts))


def _functions(motion: SampledMotion, exported: "ExportedSystem") -> str:
    """The generated functions, as a script whose method can be changed."""
    from derive.codegen.export.exported_system import Simulation
    from derive.codegen.export.target import ExportedFile
    from derive.codegen.export.targets.javascript import JavaScript

    class LiveScript(JavaScript):
        """Functions and variables of a script, instead of exports of a module."""

        integer = real = "let {name} = {value};"
        table = ("let {name} = [", "];")

        def signature(self) -> str:
            return super().signature().removeprefix("export ")

    method = method_catalogue.load(METHOD)
    start = motion.y[:, 0].tolist()
    steps = Simulation(method, motion.params, start, duration=1.0, steps=1)
    also = ["positions", *(["points"] if links(motion.module) else [])]
    program = exported.simulation(steps, ["row", "follow"], also)
    text = LiveScript(ExportedFile(motion.module.SYSTEM, "live", motion.title, program)).file()
    absent = {"points", "project", "follow"} - {*program.routines}
    text += "".join(f"\nfunction {name}() {{}}\n" for name in sorted(absent))
    return f"{text}\nfunction useMethod(method) {{\n  ({{ A, B, C, STAGES }} = method);\n}}\n"


def _values(motion: SampledMotion, exported: "ExportedSystem") -> str:
    """The start, parameters, methods and links, as JSON."""
    module, start = motion.module, motion.y[:, 0].tolist()
    masses = np.asarray(module.positions(0.0, start, motion.params))
    if not np.isfinite(masses).all():
        raise ValueError(f"a mass of {motion.title!r} is absent: give it a mass above 0")
    joined = [[kind, *(len(masses) + k for k in ends)] for kind, ends in links(module)]
    joined = joined or [[kind, *ends] for kind, ends in links_and_points(motion)[0]]
    numbers = exported.angles
    parameters = zip(exported.system.parameters_and_inputs, map(float, motion.params), strict=True)
    methods = {name: method_catalogue.load(name) for name in METHODS}
    values = {
        "coordinates": [
            {"label": plain_symbol(name), "unit": module.UNITS[name], "isAngle": k in numbers}
            for k, name in enumerate(module.COORDINATES)
        ],
        "parameters": [
            {
                "name": plain_symbol(one.symbol.name),
                "unit": one.unit,
                "value": value,
                "isPositive": bool(one.symbol.is_positive),
                "meaning": one.meaning,
            }
            for one, value in parameters
        ],
        "start": start,
        "duration": min(float(abs(motion.t[-1] - motion.t[0])), VIEWED),
        "dimension": masses.shape[1],
        "masses": len(masses),
        "points": 1 + max((k for _, ends in links(module) for k in ends), default=-1),
        "links": joined,
        "hasConstraints": has_constraints(module),
        "method": METHOD,
        "h": STEP,
        "methods": {
            name: {
                "title": one.title,
                "A": [float(a) for line in one.A for a in line],
                "B": [*map(float, one.b)],
                "b": [*map(float, one.b)],
                "C": [*map(float, one.c)],
                "STAGES": one.stages,
            }
            for name, one in methods.items()
        },
    }
    return as_json(values)
