"""The wheel: complete, the same from the source distribution, and sufficient by itself."""

import os
import subprocess
import sys
import sysconfig
import tarfile
import venv
from pathlib import Path
from zipfile import ZipFile

import pytest
from folders import ROOT

#: Python before 3.11.4 has no filters of archives.
SAFE = {"filter": "data"} if hasattr(tarfile, "data_filter") else {}
PACKAGES = ("derive", "generated", "solvers")


def run(*argv: str | Path, folder: Path) -> str:
    """Standard output of a program that does not see this repository."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(
        list(map(str, argv)),
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def build(source: Path, target: str, folder: Path) -> Path:
    pytest.importorskip("hatchling", reason="needs: pip install hatchling")
    run(sys.executable, "-m", "hatchling", "build", "-t", target, "-d", folder, folder=source)
    (built,) = folder.glob("*.whl" if target == "wheel" else "*.tar.gz")
    return built


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(ROOT, "wheel", tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def environment(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Programs of an environment with the wheel, its dependencies and a foreign `derive`."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder / "venv", with_pip=False)
    programs = folder / "venv" / "bin"
    pip = (sys.executable, "-m", "pip", "--python", programs / "python", "--quiet")
    offline = ("--no-deps", "--no-index", "--no-compile", "--disable-pip-version-check")
    run(*pip, "install", *offline, wheel, folder=folder)
    foreign = folder / "foreign"
    (foreign / "derive").mkdir(parents=True)
    (foreign / "derive" / "__init__.py").write_text("raise ImportError('a foreign package')\n")
    (site,) = (folder / "venv" / "lib").glob("*/site-packages")
    # paths in a .pth file are not searched for .pth files, such as that of this repository
    dependencies = sysconfig.get_path("purelib")
    (site / "dependencies.pth").write_text(f"{foreign}\n{dependencies}\n")
    return programs


def test_the_wheel_holds_every_file_of_the_packages(wheel: Path) -> None:
    files = {
        path.relative_to(ROOT).as_posix()
        for package in PACKAGES
        for path in (ROOT / package).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    packed = {name for name in ZipFile(wheel).namelist() if ".dist-info/" not in name}
    assert packed == files | {"holonomic.py"}
    suffixes = {Path(name).suffix for name in packed}
    assert suffixes >= {".c", ".h", ".js", ".css", ".html", ".toml", ".json", ".pyi", ".typed"}


@pytest.mark.long("builds the wheel twice")
def test_the_source_distribution_builds_the_same_wheel(wheel: Path, tmp_path: Path) -> None:
    with tarfile.open(build(ROOT, "sdist", tmp_path / "sdist")) as archive:
        archive.extractall(tmp_path, **SAFE)
    (source,) = tmp_path.glob("holonomic-*")
    again = build(source, "wheel", tmp_path / "wheel")
    assert again.name == wheel.name
    assert again.read_bytes() == wheel.read_bytes()


@pytest.mark.long("builds and installs the wheel")
def test_every_public_name_is_imported_from_the_installed_wheel(environment: Path) -> None:
    code = (
        "import derive, generated, holonomic, solvers\n"
        "for package in (derive, solvers, holonomic):\n"
        "    for name in package.__all__: getattr(package, name)\n"
        "for package in (derive, generated, solvers, holonomic): print(package.__file__)"
    )
    folder = environment.parent
    paths = run(environment / "python", "-c", code, folder=folder).splitlines()
    assert len(paths) == 4
    assert all(Path(path).is_relative_to(folder) for path in paths)


@pytest.mark.long("builds and installs the wheel")
def test_the_installed_commands_derive_and_run(environment: Path, tmp_path: Path) -> None:
    command = environment / "holonomic"
    checked = run(command, "derive", "double_pendulum", "--check", folder=tmp_path)
    assert str(environment.parent) in checked
    assert "hamiltonian" in run(command, "verify", "swinging_atwood", folder=tmp_path)
    assert "Double pendulum" in run(command, "systems", folder=tmp_path)
    assert "model: full equations" in run(command, "run", "report", folder=tmp_path)
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "report.csv",
        "report.html",
    }
