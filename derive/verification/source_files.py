"""Documents and programs by the names of their files."""

from dataclasses import replace
from pathlib import Path

from derive.reading.document import Document
from derive.reading.document_formats import read_document
from derive.reading.programs.program import Program, ProgramError
from derive.reading.programs.program_reader import known_languages, read_program
from derive.verification.documents.judgement import judge_document
from derive.verification.documents.letters.hints import Hints
from derive.verification.documents.pages.verdicts_in_place import DocumentVerdicts, FormulaVerdict
from derive.verification.documents.program_judgement import judge_program
from derive.verification.report.report_document import judge_report
from derive.verification.report.report_judgement import OrderOf
from solvers.io.toml_input import InputError


def is_program(name: str) -> bool:
    """Whether a file is a program, by its name."""
    return any(Path(name).suffix in one.suffixes for one in known_languages())


def judge_file(
    name: str, order_of: OrderOf, hints: Hints | None = None
) -> tuple[DocumentVerdicts, Document]:
    """Judge the formulas of a document, also in the programs of a notebook, or of a program.

    Without hints, the report is recognised by its displays; the orders of Runge–Kutta methods in
    it are ``order_of(A, b)``.

    Raises
    ------
    InputError
        If the file cannot be read, or is no text.
    """
    if is_program(name):
        program = _program(Path(name))
        return judge_program(program, hints), Document(name, "program", "", ())
    document = read_document(name)
    judged = None if hints else judge_report(document, order_of)
    judged = judged or judge_document(document, hints)
    for cell in document.programs:
        try:
            program = read_program(cell.text, cell.language)
        except ProgramError:  # a language that is not read, such as that of a shell
            continue
        inside = judge_program(program, hints)
        formulas = (*judged.formulas, *(_in_cell(one, cell.number) for one in inside.formulas))
        systems = dict.fromkeys(filter(None, (judged.system, inside.system)))
        conventions = dict.fromkeys(filter(None, (judged.convention, inside.convention)))
        judged = replace(
            judged,
            formulas=formulas,
            system="; ".join(systems),
            convention="; ".join(conventions),
            alternatives=(*judged.alternatives, *inside.alternatives),
        )
    return judged, document


def _program(path: Path) -> Program:
    try:
        return read_program(path)
    except ProgramError as error:
        raise InputError(f"{path}: {error}") from error
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from error


def _in_cell(formula: FormulaVerdict, cell: int) -> FormulaVerdict:
    return replace(formula, cell=cell)
