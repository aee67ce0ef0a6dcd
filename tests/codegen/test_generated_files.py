"""Generated files: what each contains, and that a copied file needs no other."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from shutil import copy

import pytest
from folders import ROOT

import generated.double_pendulum as dp
from derive import Derivation, load, names
from derive.codegen.function_specs import SPECS
from derive.codegen.module_functions import Functions
from derive.mechanics.reduced_coordinates import reduced

FOLDER = ROOT / "generated"
MODULES, HEADERS = sorted(FOLDER.glob("[a-z]*.py")), sorted(FOLDER.glob("*.h"))
START = "0.0, (0.1, 0.2, 0.3, 0.4), p.DEFAULTS"


def printed(code: str, folder: Path) -> str:
    """What a program prints that can import Python's library and the modules of a folder."""
    code = f"import sys\nsys.path.append({str(folder)!r})\n{code}"
    command = sys.executable, "-I", "-S", "-c", code
    return subprocess.run(command, text=True, check=True, capture_output=True).stdout.strip()


def test_a_copied_file_needs_no_other_and_no_package(tmp_path: Path) -> None:
    copy(dp.__file__, tmp_path / "pendulum.py")
    code = f"import pendulum as p; print(p.rhs({START}), hasattr(p, 'rhs_variational'))"
    rates = dp.rhs(0.0, (0.1, 0.2, 0.3, 0.4), dp.DEFAULTS)
    assert printed(code, tmp_path) == f"{rates} False"


def test_functions_of_the_second_file_name_it_where_it_is_missing(tmp_path: Path) -> None:
    copy(dp.__file__, tmp_path)
    use = "try: p.linear\nexcept AttributeError as error: print(error)"
    message = printed(f"import double_pendulum as p\n{use}", tmp_path)
    path = tmp_path / "double_pendulum_derivatives.py"
    assert message == f"linear is in {path}, which is missing"


def test_the_second_file_is_loaded_when_a_function_of_it_is_used(tmp_path: Path) -> None:
    for name in ("double_pendulum.py", "double_pendulum_derivatives.py"):
        copy(FOLDER / name, tmp_path)
    code = (
        "import double_pendulum as p; before = 'linear' in vars(p); p.linear(p.DEFAULTS);"
        "print(before, 'linear' in vars(p), {'linear', 'linear_many'} <= {*dir(p)})"
    )
    assert printed(code, tmp_path) == "False True True"


def test_a_second_file_of_another_version_is_refused(tmp_path: Path) -> None:
    copy(dp.__file__, tmp_path)
    text = (FOLDER / "double_pendulum_derivatives.py").read_text()
    (tmp_path / "double_pendulum_derivatives.py").write_text(text.replace(dp.DIGEST, "0" * 16))
    use = "try: p.linear\nexcept ImportError as error: print(error)"
    message = printed(f"import double_pendulum as p\n{use}", tmp_path)
    assert "double_pendulum.py differ in their versions; generate both anew" in message


def test_functions_over_arrays_take_the_arguments_of_those_over_numbers() -> None:
    y, params = (0.1, 0.2, 0.3, 0.4), dp.DEFAULTS
    expected = dp.rhs_many(0.0, y, params)
    assert (dp.rhs_many(t=0.0, params=params, y=y) == expected).all()
    for wrong in ((0.0, y), (0.0, y, params, 1.0)):
        with pytest.raises(TypeError, match="rhs"):
            dp.rhs_many(*wrong)
    with pytest.raises(TypeError, match="rhs_many takes t, y, params"):
        dp.rhs_many(0.0, y, params, t=0.0)


@pytest.mark.parametrize("name", names())
def test_a_shipped_module_has_the_functions_that_exist_for_its_system(name: str) -> None:
    module = import_module(f"generated.{name}")
    known = {spec.name for spec in SPECS}
    assert {*Functions(Derivation(reduced(load(name)))).usual} == known & {*dir(module)}


@pytest.mark.long("other tests reach its code")
def test_long_derivatives_exist_for_few_coordinates_only() -> None:
    def functions(links: int) -> set[str]:
        return {*Functions(Derivation(load(f"chain_{links}"))).names}

    left_out = {"parameter_jacobian", "rhs_sensitivity", "jacobian_hamiltonian"}
    left_out |= {"regressor", "base_parameters"}
    assert functions(15) ^ functions(16) == left_out


def test_names_that_no_file_has_are_refused() -> None:
    with pytest.raises(AttributeError, match=r"'generated.double_pendulum' has no attribute 'rsh'"):
        dp.rsh  # noqa: B018


def test_lines_are_at_most_100_columns_wide() -> None:
    widths = {path: max(map(len, path.read_text().splitlines())) for path in (*MODULES, *HEADERS)}
    assert len(widths) == 3 * len(HEADERS)
    assert {path: width for path, width in widths.items() if width > 100} == {}


def factors(node: ast.expr) -> Iterator[str]:
    """The factors of a product."""
    match node:
        case ast.BinOp(left, ast.Mult(), right):
            yield from factors(left)
            yield from factors(right)
        case _:
            yield ast.unparse(node)


def products_with_reciprocals(source: str) -> list[str]:
    """Products of a named value and its named reciprocal."""
    found = []
    for function in ast.parse(source).body:
        reciprocals = {
            ast.unparse(one.targets[0]): ast.unparse(one.value.right)
            for one in ast.walk(function)
            if isinstance(one, ast.Assign)
            and isinstance(one.value, ast.BinOp)
            and isinstance(one.value.op, ast.Div)
            and ast.unparse(one.value.left) == "1.0"
        }
        for node in ast.walk(function):
            if isinstance(node, ast.BinOp):
                parts = [*factors(node)]
                found += [ast.unparse(node) for x in parts if reciprocals.get(x) in parts]
    return found


@pytest.mark.long("other tests reach its code")
def test_no_product_contains_a_factor_and_its_reciprocal() -> None:
    assert [path.name for path in MODULES if products_with_reciprocals(path.read_text())] == []
    planted = "def f(a):\n    c0 = a + 1.0\n    c1 = 1.0/c0\n    c2 = a*c0*c1\n    return c2\n"
    assert products_with_reciprocals(planted) == ["a * c0 * c1"]


def opposite_terms(source: str) -> list[str]:
    """Sums that contain a term and its opposite, also in brackets."""

    def terms(node: ast.expr, sign: int) -> Iterator[tuple[str, int]]:
        match node:
            case ast.BinOp(left, ast.Add() | ast.Sub() as operation, right):
                yield from terms(left, sign)
                yield from terms(right, sign if isinstance(operation, ast.Add) else -sign)
            case ast.UnaryOp(ast.USub(), operand):
                yield from terms(operand, -sign)
            case _:
                yield ast.unparse(node), sign

    sums = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.BinOp))
    signs = ((node, {*terms(node, 1)}) for node in sums)
    return [ast.unparse(node) for node, pairs in signs if len({x for x, _ in pairs}) < len(pairs)]


@pytest.mark.long("other tests reach its code")
def test_no_sum_contains_a_term_and_its_opposite() -> None:
    assert [path.name for path in MODULES if opposite_terms(path.read_text())] == []
    assert opposite_terms("x = 2.0*a + (b - 2.0*a)") == ["2.0 * a + (b - 2.0 * a)"]
