"""Each function of a module that does not ship is generated when it is first used."""

import inspect
import math
from pathlib import Path
from types import ModuleType
from typing import Any, cast

import pytest
from sympy import besselj, symbols

from derive import Coordinate, Derivation, Parameter, PointMass, System, reduced
from derive.codegen import module_functions as codegen
from derive.codegen.expression_graph.sympy_translation import UnsupportedFunctionError
from derive.codegen.module_files import files as files_of
from derive.system.files import system_catalogue
from solvers import integrate, load
from solvers.app.modules import build
from solvers.equations.module import GeneratedModule, depends_on_time, has_function, header
from solvers.io import build_cache

#: Systems whose equations have loops, constraints, quaternions and integrals.
SYSTEMS = ("chain_4", "chain_16", "cart_2", "four_bar", "free_body", "rolling_disc", "peaucellier")
X, M, A = symbols("x m a", real=True)


@pytest.fixture
def generated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the functions that are generated, with an empty cache."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    names: list[str] = []
    lowering = codegen._lowering

    def recorded(spec: Any, derivation: Derivation) -> Any:
        names.append(spec.name)
        return lowering(spec, derivation)

    monkeypatch.setattr(codegen, "_lowering", recorded)
    return names


def swing(potential: Any) -> System:
    """A bead on a line in a potential."""
    return System(
        name="swing",
        title="Bead on a line",
        coordinates=(Coordinate(X, "m", "place"),),
        parameters=(Parameter(M, "kg", 1.0, "mass"), Parameter(A, "1", 0.5, "number")),
        masses=(PointMass(M, (X, 0)),),
        potential=potential,
    )


@pytest.mark.long("other tests reach its code")
@pytest.mark.usefixtures("predictable_times")
def test_only_functions_that_are_used_are_generated(generated: list[str]) -> None:
    module = load("chain_4")
    assert generated == ["rhs_rational"]
    assert has_function(module, "jacobian")
    assert not depends_on_time(module)
    assert generated == ["rhs_rational", "rhs"]
    motion = integrate(module, (0.0, 0.1), (0.1, 0.2, 0.3, 0.4, 0, 0, 0, 0), module.DEFAULTS)
    assert motion.backend.startswith("compiled")
    used = {"rhs_rational", "rhs", "mass_matrix", "rhs_variational", "energy", "equilibrium"}
    assert {*generated} == used
    state = motion.y[:, -1]
    rates = module.rhs(0.0, state, module.DEFAULTS)
    assert module.rhs_many(0.0, state, module.DEFAULTS) == pytest.approx(rates)
    module.jacobian(0.0, state, module.DEFAULTS)
    assert len(generated) == len({*generated})  # each once
    assert "jacobian" in generated
    assert "parameter_jacobian" not in generated
    generated.clear()
    again = load("chain_4")
    assert again.jacobian(0.0, state, again.DEFAULTS)
    assert not generated  # they are in the cache


@pytest.mark.long("more cases of the same kind", keep=1, daily=4)
@pytest.mark.parametrize("name", SYSTEMS)
def test_functions_in_parts_are_those_of_the_whole_module(name: str) -> None:
    system = system_catalogue.load(name)
    lazy, whole = build(system), ModuleType(name)
    functions = codegen.Functions(Derivation(reduced(system)))
    files = files_of(functions.part(functions.names))
    exec(compile(files[f"{name}.py"], f"<{name}>", "exec"), vars(whole))
    module = cast("GeneratedModule", whole)
    public = {key for key in vars(whole) if not key.startswith("_") and key not in dir(math)}
    assert public - {"annotations", "TYPE_CHECKING"} <= {*dir(lazy)}
    for function in module.OPERATIONS:
        for kind in ("", "_many"):
            source = inspect.getsource(getattr(lazy, f"{function}{kind}"))
            assert source.rstrip() in files[f"{name}.py"]
    tables = [key for key in public if key.isupper()]
    assert {key: getattr(lazy, key) for key in tables} == {key: vars(whole)[key] for key in tables}
    assert lazy.__file__ is not None
    assert Path(lazy.__file__).read_text() == files[f"{name}.py"]
    path = header(lazy)
    assert path is not None
    assert path.read_text() == files[f"{name}.h"]


def test_unknown_attributes_and_functions_are_refused() -> None:
    module = load("chain_4")
    with pytest.raises(AttributeError, match="the module of chain_4 has no attribute 'rsh'"):
        module.rsh  # type: ignore[attr-defined]  # noqa: B018
    assert not hasattr(module, "power")
    assert repr(module).endswith("chain_4', generated as used>")


@pytest.mark.parametrize(
    ("potential", "reason"), [(besselj(0, A * X), "besselj"), (10**400 * X**4, "out of range")]
)
def test_equations_without_code_are_refused_at_once(potential: Any, reason: str) -> None:
    with pytest.raises(UnsupportedFunctionError, match=reason):
        build(swing(potential))


def test_where_nothing_can_be_written_functions_are_generated_in_memory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def read_only(*_: object, **__: object) -> str:
        raise OSError(30, "Read-only file system", "/a/name")

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file" / "no"))
    (tmp_path / "file").touch()
    build_cache._temporary_folder.cache_clear()
    monkeypatch.setattr(build_cache.tempfile, "mkdtemp", read_only)
    reason = "^integrating in Python: nothing can be built"
    with pytest.warns(UserWarning, match=reason) as first:
        module = build(swing(A * X**4))
    with pytest.warns(UserWarning, match=reason) as others:
        motion = integrate(module, (0.0, 0.1), (1.0, 0.0), module.DEFAULTS)
    assert motion.backend == "python"
    assert len({str(notice.message) for notice in (*first, *others)}) == 1  # which is shown once
