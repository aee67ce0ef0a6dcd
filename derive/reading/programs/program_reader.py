"""Read a program: its equations, and its method of integration."""

import re
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

from derive.reading.programs import languages
from derive.reading.programs.evaluation.context import ProgramContext
from derive.reading.programs.findings.program_findings import Findings
from derive.reading.programs.findings.regions import derived_constants, prepare, regions
from derive.reading.programs.findings.symbolic_statements import symbolic_statements
from derive.reading.programs.languages.language import Language
from derive.reading.programs.program import Program, ProgramError
from derive.reading.programs.syntax.code import Statement
from derive.reading.programs.syntax.statement_translation import StatementTranslator
from solvers.io.suggestion import did_you_mean
from solvers.io.toml_input import read_bytes

#: Characters of the longest program, and bytes of its file.
MAX_LENGTH, MAX_BYTES = 100_000, 400_000
#: Characters of the longest line; only generated programs have longer ones.
MAX_LINE = 5_000
#: The end of a line that is continued in the next one.
CONTINUED = re.compile(r"(?:\.\.\.|&|\\)[^\S\n]*\n")


def read_program(source: Path | str, language: str | None = None) -> Program:
    """Read a program from a file, or from its text if the language is given.

    Nothing of the program is executed. `source` is a path, or with `language`, such as
    ``"Python"``, the text of a program.

    Raises
    ------
    ProgramError
        If the language is unknown, if the text is binary or too long, or if tree-sitter is not
        installed.
    InputError
        If the path is that of no file, or of one that is too large.
    OSError
        If the file cannot be read.
    """
    if language is None or isinstance(source, Path):
        path = Path(source)
        text, file = read_bytes(path, MAX_BYTES).decode("utf-8", "replace"), str(path)
        chosen = by_name(language) if language else by_suffix(path)
    else:
        text, file, chosen = source, "", by_name(language)
    _check(text)
    try:
        return _read(file, text, chosen)
    except RecursionError:
        raise ProgramError("the functions of the program are nested too deeply") from None


def _check(text: str) -> None:
    """Raise `ProgramError` for texts that are no programs."""
    if len(text) > MAX_LENGTH:
        raise ProgramError(f"a program of {len(text)} characters; at most {MAX_LENGTH} allowed")
    longest = max(map(len, CONTINUED.sub("", text).splitlines()), default=0)
    if longest > MAX_LINE:
        raise ProgramError(f"a line has {longest} characters; at most {MAX_LINE} allowed")
    if "\0" in text:
        raise ProgramError("the program is no text: it contains null characters")


def known_languages() -> tuple[Language, ...]:
    """All languages: those of every file in the package `languages`."""
    package = languages.__name__
    modules = (import_module(f"{package}.{one.name}") for one in iter_modules(languages.__path__))
    return tuple(
        one for each in modules for one in vars(each).values() if isinstance(one, Language)
    )


def by_suffix(path: Path) -> Language:
    """The language of a file by its suffix."""
    for one in known_languages():
        if path.suffix in one.suffixes:
            return one
    known = " ".join(suffix for one in known_languages() for suffix in one.suffixes)
    raise ProgramError(f"{path.name}: unknown suffix {path.suffix!r}; known are: {known}")


def by_name(name: str) -> Language:
    """The language of a name, in capital letters or small ones."""
    names = {other: one for one in known_languages() for other in (one.name, *one.other_names)}
    for other, one in names.items():
        if name.lower() == other.lower():
            return one
    raise ProgramError(
        f"unknown language {name[:50]!r}{did_you_mean(name, names)}; known are: {', '.join(names)}"
    )


def _read(file: str, text: str, language: Language) -> Program:
    body = StatementTranslator(language).statements([language.parse(text)])
    program, derived = _followed(file, language, body)
    if derived and program.functions:
        short = {
            one.line: one.equations for one in _followed(file, language, body, derived)[0].functions
        }
        functions = (replace(one, short=short.get(one.line, ())) for one in program.functions)
        program = replace(program, functions=tuple(functions))
    if not program.functions and language.name == "Python" and "sympy" in text:
        stated = symbolic_statements(language.prepared(text))
        return replace(program, functions=(stated,)) if stated else program
    return program


def _followed(
    file: str, language: Language, body: tuple[Statement, ...], kept: frozenset[str] = frozenset()
) -> tuple[Program, frozenset[str]]:
    """The program with some names as letters, and names of constants that others define."""
    context = ProgramContext(language, kept=kept)
    prepare(context, body)
    findings = Findings(context, body)
    for region in regions(context, body):
        findings.add(region)
    return findings.program(file, language.name), derived_constants(context)
