"""``make bench``: its parts, their order, and what ends it."""

import json

import pytest
from benchmarks import __main__ as bench

from solvers.integration.compiled import compiler
from solvers.integration.compiled.kernel import kernel


@pytest.mark.parametrize("is_json", [True, False])
def test_measurements_of_the_parts_are_printed_in_their_order(
    is_json: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(bench, "_results", lambda part, _: ({"time": 2.5}, [f"{part} 2.5 s"]))
    assert bench.main(["maps", "chains", *["--json"] * is_json]) == 0
    output = capsys.readouterr().out
    if is_json:
        assert json.loads(output) == {"chains": {"time": 2.5}, "maps": {"time": 2.5}}
    else:
        assert output == "chains 2.5 s\nmaps 2.5 s\n"


def test_unknown_parts_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        bench.main(["mapss"])
    assert "PART must be one of pendulum, starts" in capsys.readouterr().err


def test_benchmarks_without_a_compiler_end_with_the_reason(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(compiler, "compilers", lambda: iter(()))
    kernel.cache_clear()
    assert bench.main([]) == 4
    kernel.cache_clear()
    message = capsys.readouterr().err
    assert message.startswith("benchmarks: no C compiler built the library (none was found)")
    assert message.count("\n") == 1
