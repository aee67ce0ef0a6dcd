"""Functional mock-up units, FMI 3.0: exported C code, its library and its description."""

import platform
import subprocess
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING
from xml.etree.ElementTree import Element, SubElement, indent, tostring
from zipfile import ZIP_DEFLATED, ZipFile

from solvers.integration.compiled.compiler import NoCompilerError, compilers
from solvers.io.atomic_write import write_text

if TYPE_CHECKING:
    from derive import Simulation, System

#: Flags that keep the bits of other targets, on every processor of the architecture.
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared")
SYSTEMS = {
    "Linux": ("linux", ".so"),
    "Darwin": ("darwin", ".dylib"),
    "Windows": ("windows", ".dll"),
}
MACHINES = {"x86_64": "x86_64", "AMD64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}


def write_unit(system: "System", simulation: "Simulation", folder: Path) -> Path:
    """Write a unit for model exchange and co-simulation, with its source and a library.

    Its states and outputs are coordinates and velocities, its parameters and inputs those of the
    system; co-simulation has the method and tolerances of the simulation. An event is an event
    indicator, and ends steps of co-simulation where the importer permits an early return.

    Parameters
    ----------
    system : derive.System
        The system.
    simulation : derive.Simulation
        The start, parameters, duration, and the method of co-simulation with controlled steps.
    folder : Path
        The folder, created if it is missing.

    Returns
    -------
    Path
        The path of the unit, a file that ends in ``.fmu``.

    Raises
    ------
    NoCompilerError
        When no C compiler builds the library.
    OSError
        When units have no name for libraries of this operating system.
    """
    from derive import reduced
    from derive.codegen.export.language_export import exported_text

    name, source = exported_text(system, "fmu", simulation)
    stem = Path(name).stem
    if platform.system() not in SYSTEMS:
        raise OSError(
            f"units have no name for libraries of {platform.system()}: use another target"
        )
    system_name, ending = SYSTEMS[platform.system()]
    machine = MACHINES.get(platform.machine(), platform.machine())
    with TemporaryDirectory() as temporary:
        unit = Path(temporary) / f"{stem}.fmu"
        description = _description(reduced(system), simulation, stem, source)
        with ZipFile(unit, "w", ZIP_DEFLATED) as file:
            file.writestr("modelDescription.xml", description)
            file.writestr(f"sources/{name}", source)
            file.writestr("sources/buildDescription.xml", _build_description(stem, name))
            path = f"binaries/{machine}-{system_name}/{stem}{ending}"
            file.writestr(path, _library(source, Path(temporary)))
        folder.mkdir(parents=True, exist_ok=True)
        write_text(folder / unit.name, unit.read_bytes())
    return folder / f"{stem}.fmu"


def _library(source: str, folder: Path) -> bytes:
    (folder / "unit.c").write_text(source, encoding="utf-8")
    errors = []
    for compiler in compilers():
        command = [*compiler, *FLAGS, "unit.c", "-o", "unit", "-lm"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode == 0:
            return (folder / "unit").read_bytes()
        errors.append(f"{compiler[0]}: {done.stderr[:500]}")
    tried = "; ".join(errors) or "none was found"
    raise NoCompilerError(f"no C compiler built the unit ({tried}): install one as `cc`")


def _description(system: "System", simulation: "Simulation", stem: str, source: str) -> str:
    """The variables of a unit, with references as in its C source."""
    root = Element(
        "fmiModelDescription",
        fmiVersion="3.0",
        modelName=system.title,
        instantiationToken=sha256(source.encode()).hexdigest()[:32],
        generationTool="holonomic",
    )
    SubElement(root, "ModelExchange", modelIdentifier=stem, canGetAndSetFMUState="true")
    SubElement(
        root,
        "CoSimulation",
        modelIdentifier=stem,
        canHandleVariableCommunicationStepSize="true",
        canGetAndSetFMUState="true",
        hasEventMode=str(simulation.event is not None).lower(),
    )
    SubElement(root, "DefaultExperiment", startTime="0", stopTime=repr(simulation.duration))
    variables = SubElement(root, "ModelVariables")
    structure = SubElement(root, "ModelStructure")

    def variable(name: str, reference: int, meaning: str = "", **attributes: str) -> None:
        shown = {"description": meaning} if meaning else {}
        given = {"name": name, "valueReference": str(reference), **shown, **attributes}
        SubElement(variables, "Float64", given)

    n = len(system.q)
    variable("time", 0, causality="independent", variability="continuous")
    meanings = [f"{c.meaning} [{c.unit}]" for c in system.coordinates]
    meanings += [f"rate of {c.symbol} [{c.unit}/s]" for c in system.coordinates]
    symbols = (*system.q, *system.qdot)
    for k, (symbol, meaning) in enumerate(zip(symbols, meanings, strict=True)):
        start = repr(float(simulation.y0[k]))
        variable(symbol.name, 1 + k, meaning, causality="output", initial="exact", start=start)
        SubElement(structure, "Output", valueReference=str(1 + k))
    variable("energy", 2 * n + 1, "energy [J]", causality="output", initial="calculated")
    SubElement(structure, "Output", valueReference=str(2 * n + 1))
    for k, symbol in enumerate(symbols):
        variable(f"der({symbol})", 2 * n + 2 + k, derivative=str(1 + k), initial="calculated")
        SubElement(structure, "ContinuousStateDerivative", valueReference=str(2 * n + 2 + k))
    events = []
    if simulation.event:
        events.append(4 * n + 2)
        about = f"{simulation.event[0]} - {simulation.event[1]!r}, which is 0 at events"
        variable("event", events[0], about, causality="local")
    for k, part in enumerate(system.parameters_and_inputs):
        start = repr(float(simulation.params[k]))
        is_input = part.symbol in system.u
        kind = {"causality": "input"} if is_input else {"causality": "parameter"}
        kind |= {"variability": "continuous" if is_input else "tunable"}
        text = f"{part.meaning} [{part.unit}]"
        variable(part.symbol.name, 4 * n + 2 + len(events) + k, text, start=start, **kind)
    for reference in (2 * n + 1, *range(2 * n + 2, 4 * n + 2)):
        SubElement(structure, "InitialUnknown", valueReference=str(reference))
    for reference in events:
        SubElement(structure, "EventIndicator", valueReference=str(reference))
    indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(root, "unicode")}\n'


def _build_description(stem: str, name: str) -> str:
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    build = SubElement(root, "BuildConfiguration", modelIdentifier=stem)
    files = SubElement(build, "SourceFileSet", language="C99", compilerOptions="-ffp-contract=off")
    SubElement(files, "SourceFile", name=name)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(root, "unicode")}\n'
