"""``holonomic export``."""

from argparse import ArgumentParser, Namespace
from pathlib import Path

from derive.system.files.shipped import large_names, names
from solvers.app.commands import options

SUMMARY = "write equations or a whole simulation in another language"


def add_arguments(parser: ArgumentParser) -> None:
    """Describe the command and its arguments."""
    parser.description = (
        "Write the functions of a system, or the simulation of a scene, as one file of another "
        "language that needs nothing else. A simulation has the equations, a method, step "
        "control, output and events; where it calls no function such as a sine, its results are "
        "equal bit for bit in all languages."
    )
    meaning = "a scene or a system: a name, or a file that ends in .toml"
    action = parser.add_argument("name", metavar="SCENE|SYSTEM", help=meaning)
    known = (*options.shipped("scenes"), *names(), *large_names())
    options.complete_with(action, "exports", known)
    parser.add_argument("--to", metavar="TARGET", required=True, help="the language, see below")
    meaning = "in a simulation, also a row of output wherever a coordinate or velocity has a value"
    parser.add_argument("--event", metavar="'NAME = VALUE'", help=meaning)
    options.add_output(parser, "the file", default=".")
    setattr(parser, "listing", _listing)  # noqa: B010  the attribute is that of our parser
    options.add_examples(
        parser,
        "holonomic export double_pendulum --to javascript",
        "holonomic export report --to rust --output build",
    )


def _listing() -> str:
    from derive.codegen.export.target import find_targets

    rows = (f"  {name:12} {one.title}" for name, one in find_targets().items())
    return "\n".join(["targets:", *rows])


def run(arguments: Namespace) -> int:
    """Write the file; print its path, and how to run it."""
    from derive.codegen.export.language_export import export, target_of
    from derive.system.files.system_catalogue import UnknownSystemError, load
    from solvers.app.mockup_unit import write_unit
    from solvers.app.simulation_export import of_scene
    from solvers.io.suggestion import did_you_mean

    target, name, event = target_of(arguments.to), arguments.name, arguments.event
    if not _is_scene(name):
        if event:
            raise ValueError(f"--event belongs to the simulation of a scene; {name} is a system")
        try:
            system = load(name)
        except UnknownSystemError as error:
            near = did_you_mean(name, (*options.shipped("scenes"), *names()))
            raise ValueError(f"no scene is called {name!r}{near}, and {error}") from error
        print(export(system, arguments.to, arguments.output))
        return 0
    system, simulation = of_scene(
        name, event or "", single=target.is_single, fixed=target.has_fixed_steps
    )
    if arguments.to == "fmu":  # not a text: a library and its description, too
        path = write_unit(system, simulation, arguments.output)
    else:
        path = export(system, arguments.to, arguments.output, simulation=simulation)
    print(path, simulation.note, sep="\n")
    if target.is_program:
        print(f"run it with: {target.command.format(file=path.name, stem=path.stem)}")
    return 0


def _is_scene(name: str) -> bool:
    from solvers.io.toml_input import read_table

    path = Path(name)
    if path.suffix != ".toml":
        return name in options.shipped("scenes")
    return path.is_file() and "duration" in read_table(path, "")
