"""The benchmark of mechanisms measures errors against independent references."""

from importlib import import_module
from types import ModuleType

import numpy as np
import pytest
from benchmarks import equal_error, exudyn, squeezer
from benchmarks.mechanism_models import END, MECHANISMS, Bar
from benchmarks.textbook_squeezer import textbook
from rigid_body_motions import top_inclination
from scipy.integrate import quad

from holonomic import integrate, load

#: Angles of the squeezer at 0.03 s: F. Mazzia, C. Magherini, Test Set for Initial Value Problem
#: Solvers, II.10.
SQUEEZED = (
    *(15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948),
    *(0.5244099658805304, 0.5347301163226948, 1.048080741042263),
)


@pytest.fixture(scope="module", params=MECHANISMS)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def bars(name: str, phi: complex, p: dict[str, float]) -> list[tuple[float, float, tuple]]:
    """Mass, length and ends of the bars for an angle of the crank, from circles that intersect."""
    radius = p["r" if name == "slider_crank" else "a"]
    crank = (radius * np.cos(phi), radius * np.sin(phi))
    if name == "slider_crank":
        slider = (crank[0] + np.sqrt(p["l"] ** 2 - crank[1] ** 2), 0.0)
        rod = (p["m2"], p["l"], (crank, slider))
        return [(p["m1"], radius, ((0, 0), crank)), rod, (p["M"], 0.0, (slider, slider))]
    along, up = p["d"] - crank[0], -crank[1]
    square = along**2 + up**2
    part = (p["b"] ** 2 - p["c"] ** 2 + square) / (2 * square)
    height = np.sqrt(p["b"] ** 2 / square - part**2)
    joint = (crank[0] + part * along - height * up, crank[1] + part * up + height * along)
    ends = ((0, 0), crank), (crank, joint), (joint, (p["d"], 0.0))
    sizes = ("m1", "a"), ("m2", "b"), ("m3", "c")
    return [(p[mass], p[size], end) for (mass, size), end in zip(sizes, ends, strict=True)]


def energies(name: str, phi: float, p: dict[str, float]) -> tuple[float, float]:
    """Twice the kinetic energy per square of the crank's velocity, and the potential energy."""
    inertia = potential = 0.0
    for mass, length, ends in bars(name, phi + 1e-30j, p):
        (x1, y1), (x2, y2) = ((np.imag(x) / 1e-30, np.imag(y) / 1e-30) for x, y in ends)
        inertia += mass * ((x1 + x2) ** 2 + (y1 + y2) ** 2) / 4
        if length:  # a uniform bar about its centre
            inertia += mass * ((x2 - x1) ** 2 + (y2 - y1) ** 2) / 12
        potential += mass * p["g"] * float(np.real(ends[0][1] + ends[1][1])) / 2
    return inertia, potential


def closed_form_error(name: str, module: ModuleType, p: dict[str, float]) -> float:
    """How far the benchmark's reference is from closed forms, with parameters `p`."""
    mechanism = MECHANISMS[name]
    start = dict(zip(module.STATE, mechanism.whole_start(module), strict=True))
    end = mechanism.reference(module)
    if name == "heavy_top":
        across = p["A"] + p["m"] * p["l"] ** 2
        rates = (start["theta"], start["phi_dot"], start["psi_dot"])
        weight, times = p["m"] * p["g"] * p["l"], np.array([END])
        cosine = top_inclination((across, p["C"]), weight, rates, times).item()
        return abs(cosine - float(np.cos(end[2])))
    # one degree of freedom: velocities from the energy, and time by a quadrature
    inertia, potential = energies(name, start["phi"], p)
    energy = inertia * start["phi_dot"] ** 2 / 2 + potential

    def pace(phi: float) -> float:
        inertia, potential = energies(name, phi, p)
        return float(np.sqrt(inertia / (2 * (energy - potential))))

    time, _ = quad(pace, start["phi"], end[0], epsabs=1e-12, epsrel=1e-12, limit=500)
    return max(abs(time - END) / pace(end[0]), abs(1 / pace(end[0]) - end[len(end) // 2]))


@pytest.mark.long("other tests reach its code")
def test_references_are_closed_forms_and_a_wrong_mass_is_seen(name: str) -> None:
    module = load(name)
    params = dict(zip(module.PARAMETERS, module.DEFAULTS, strict=True))
    assert closed_form_error(name, module, params) < 1e-10
    mass = "m" if name == "heavy_top" else "m2"
    assert closed_form_error(name, module, params | {mass: params[mass] * 1.001}) > 1e-6


@pytest.mark.long("other tests reach its code")
def test_our_programs_reach_the_reference(name: str) -> None:
    module, mechanism = load(name), MECHANISMS[name]
    start, exact = mechanism.whole_start(module).tolist(), mechanism.reference(module)
    for tol, most in ((1e-5, 1e-2), (1e-11, 1e-8)):
        programs = equal_error.programs(
            module, start, END, tol, lambda state: mechanism.part(module, state)
        )
        assert len(programs) == 4
        for run, end in programs.values():
            run()
            assert np.abs(end() - exact).max() < most


def test_exudyn_has_the_same_mechanisms(name: str) -> None:
    pytest.importorskip("exudyn", reason="needs: pip install 'holonomic[bench]'")
    package = exudyn.fast(import_module)
    module, mechanism = load(name), MECHANISMS[name]
    exact = mechanism.reference(module)
    coarse, fine = mechanism.steps[1:3]
    errors = [
        np.abs(mechanism.exudyn(package, module, steps)() - exact).max() for steps in (coarse, fine)
    ]
    order = np.log2(errors[0] / errors[1])
    assert order == pytest.approx(2, abs=0.05) if name != "heavy_top" else order > 5


def test_a_mass_at_the_end_of_a_bar_is_part_of_its_link() -> None:
    link = Bar(0.0, 0.0, 2.0, 3.0, tip=1.0).link(Bar(0.0, 0.0, 0.5, 1.0))
    assert (link.mass, link.joint) == (4.0, (0.5, 0.0, 0.0))
    assert link.centre[0] * 4.0 == pytest.approx(3.0 * 1.0 + 1.0 * 2.0)
    about_joint = link.moments[2] + 4.0 * link.centre[0] ** 2
    assert about_joint == pytest.approx(3.0 * 2.0**2 / 3 + 1.0 * 2.0**2)


@pytest.mark.long("derives a large mechanism")
def test_the_textbook_s_squeezer_is_the_generated_one() -> None:
    module = load("andrews_squeezer")
    times = np.linspace(0.0, squeezer.END, 7)
    options = {"rtol": 1e-12, "atol": 1e-12, "t_eval": times}
    motion = integrate(module, (0.0, squeezer.END), squeezer.START, module.DEFAULTS, **options)
    for y in motion.y.T:
        rates = np.array(module.rhs(0.0, y, module.DEFAULTS))
        np.testing.assert_allclose(textbook(0.0, y), rates, atol=1e-12 * np.abs(rates).max())
    assert motion.y[:7, -1] == pytest.approx(SQUEEZED, abs=1e-8)
    run, _ = squeezer.radau(1e-6)
    assert 1e-9 < np.abs(run() - SQUEEZED).max() < 1e-5  # type: ignore[operator]


def test_only_errors_that_the_other_program_reaches_are_compared() -> None:
    curve = [(1e-3, 1e-2), (2e-3, 1e-5)]
    curves = dict.fromkeys(equal_error.METHODS, curve)
    curves |= {"gauss8": [(1e-4, 1e-2), (2e-4, 1e-5)], equal_error.CALL: curve}
    curves[equal_error.OTHER] = [(0.1, 1e-2), (1.0, 1e-4)]
    (row,) = equal_error.rows((1e-3, 1e-5), curves)
    assert (row["method"], row["global_error"]) == ("gauss8", 1e-3)
    lines = list(equal_error.table([{"system": "bead"} | row], "system", "Other"))
    assert lines[0].split()[-3:] == ["Other", "/", "call"]
    assert float(lines[1].split()[-2].replace(",", "")) > 1000
