"""Each step of a derivation against an independent calculation."""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest
import sympy as sp
from sympy.physics.mechanics import LagrangesMethod, Lagrangian, Particle, Point, ReferenceFrame
from sympy.physics.mechanics import dynamicsymbols as dynamic

from derive import TIME, Coordinate, Derivation, Parameter, PointMass, RigidBody, System
from derive.codegen.module_functions import contents
from derive.formulas.zero import vanishes
from derive.mechanics.energies.reduction import collected, reduced
from derive.mechanics.linearisation.closed_form_equilibria import _roots
from derive.system.parts import SystemDefinitionError

Motion = dict[sp.Symbol, sp.Expr]


def potential(system: System) -> sp.Expr:
    """Gravity, and the energy of springs by hand."""
    symbols = {s.name: s for s in (*system.q, *system.params)}
    gravity = sum(mass.mass * symbols["g"] * mass.position[-1] for mass in system.masses)
    if system.name == "elastic_pendulum":
        return gravity + symbols["k"] / 2 * (symbols["r"] - symbols["l"]) ** 2
    return gravity


def test_accelerations_agree_with_sympys_own_lagranges_method(derivation: Derivation) -> None:
    system = derivation.system
    q = [dynamic(s.name) for s in system.q]
    functions = dict(zip(system.q, q, strict=True))
    frame, origin = ReferenceFrame("N"), Point("O")
    origin.set_vel(frame, 0)
    particles = []
    for k, mass in enumerate(system.masses):
        x, y = (component.subs(functions) for component in mass.position)
        point = origin.locatenew(f"P{k}", x * frame.x + y * frame.y)
        point.set_vel(frame, point.pos_from(origin).dt(frame))
        particle = Particle(f"p{k}", point, mass.mass)
        particles.append(particle)
    particles[0].potential_energy = potential(system).subs(functions)
    method = LagrangesMethod(Lagrangian(frame, *particles), q)
    method.form_lagranges_equations()
    t = dynamic._t
    back = (
        {x.diff(t): s for x, s in zip(q, system.qdot, strict=True)},
        dict(zip(q, system.q, strict=True)),
    )
    mass_matrix, forcing = (
        sp.Matrix(m).subs(back[0]).subs(back[1]) for m in (method.mass_matrix, method.forcing)
    )
    residuals = mass_matrix * derivation.accelerations - forcing
    assert all(vanishes(entry) for entry in residuals)


def test_newtons_law_gives_the_same_accelerations_and_rod_tensions(double: Derivation) -> None:
    # the report's (15) and (16) as they are printed, solved for accelerations and tensions
    system = double.system
    m1, m2, l1, l2, g = system.params
    T1, T2 = tensions = sp.symbols("T1 T2")
    rates = dict(zip(system.q + system.qdot, system.qdot + system.qddot, strict=True))

    def ddt(vector: sp.Matrix) -> sp.Matrix:
        return sum((vector.diff(s) * rate for s, rate in rates.items()), sp.zeros(2, 1))

    r1, r2 = (sp.Matrix(mass.position) for mass in system.masses)
    down = sp.Matrix([0, -g])
    F1 = -T1 / l1 * r1 + T2 / l2 * (r2 - r1) + m1 * down
    F2 = -T2 / l2 * (r2 - r1) + m2 * down
    laws = [*(m1 * ddt(ddt(r1)) - F1), *(m2 * ddt(ddt(r2)) - F2)]
    matrix, right = sp.linear_eq_to_matrix(laws, [*system.qddot, *tensions])
    symbols = (*system.q, *system.qdot, *system.params)
    for seed in range(5):
        state = {s: sp.Rational(7 * k + seed + 2, 3 * k + 5) for k, s in enumerate(symbols)}
        solution = matrix.evalf(50, subs=state).LUsolve(right.evalf(50, subs=state))
        state |= dict(zip(system.qddot, solution[:2], strict=True))
        derived = [*double.accelerations, *double.reactions]
        for value, formula in zip(solution, derived, strict=True):
            assert abs(value - formula.evalf(50, subs=state)) < 1e-40


def test_the_lagrangian_is_kinetic_minus_potential_energy_of_the_masses(
    derivation: Derivation,
) -> None:
    system = derivation.system
    direct = -potential(system) + sum(
        mass.mass * sp.Matrix(v).dot(sp.Matrix(v)) / 2
        for mass, v in zip(system.masses, derivation.velocities, strict=True)
    )
    assert vanishes(derivation.lagrangian - direct)
    assert not vanishes(derivation.lagrangian + direct)


def test_euler_lagrange_residuals_are_the_derivatives_of_the_lagrangian(
    derivation: Derivation,
) -> None:
    system, L = derivation.system, derivation.lagrangian
    rates = dict(zip(system.q + system.qdot, system.qdot + system.qddot, strict=True))
    for q, qdot, residual in zip(system.q, system.qdot, derivation.euler_lagrange, strict=True):
        p = L.diff(qdot)
        ddt = sum(p.diff(s) * rate for s, rate in rates.items())
        assert vanishes(residual - (ddt - L.diff(q)))
        assert vanishes(derivation.momenta[system.q.index(q)] - p)


def test_the_hamiltonian_is_the_legendre_transform_and_gives_the_same_motion(
    derivation: Derivation, motion: Motion
) -> None:
    system = derivation.system
    momenta = dict(zip(system.p, derivation.momenta, strict=True))
    legendre = sum(p * v for p, v in zip(derivation.momenta, system.qdot, strict=True))
    H = derivation.hamiltonian.subs(momenta)
    assert vanishes(H - (legendre - derivation.lagrangian))
    rates = dict(zip(system.q + system.qdot, system.qdot + system.qddot, strict=True))
    velocities, forces = derivation.hamilton_equations
    for v, p, by_p, by_q in zip(system.qdot, derivation.momenta, velocities, forces, strict=True):
        assert vanishes(by_p.subs(momenta) - v)
        pdot = sum(p.diff(s) * rate for s, rate in rates.items()).subs(motion)
        assert vanishes(by_q.subs(momenta) - pdot)


def test_energy_is_conserved(derivation: Derivation, motion: Motion) -> None:
    system, E = derivation.system, derivation.energy
    rates = dict(zip(system.q + system.qdot, system.qdot + system.qddot, strict=True))
    power = sum(E.diff(s) * rate for s, rate in rates.items()).subs(motion)
    assert vanishes(power)
    damped = {a: rhs - v / 10 for (a, rhs), v in zip(motion.items(), system.qdot, strict=True)}
    assert not vanishes(sum(E.diff(s) * rate for s, rate in rates.items()).subs(damped))


def test_small_motions_of_the_double_pendulum_have_the_textbook_frequencies(
    double: Derivation,
) -> None:
    # equal masses and lengths: ω² = (2 ± √2) g/l (Landau and Lifshitz, Mechanics, § 23)
    m1, m2, l1, l2, g = double.system.params
    linear = double.linearisation()
    equal = {m2: m1, l2: l1}
    K, M = (m.subs(equal) for m in (linear.stiffness_matrix, linear.mass_matrix))
    for sign in (1, -1):
        assert sp.simplify((K - (2 + sign * sp.sqrt(2)) * g / l1 * M).det()) == 0
    assert sp.simplify((K - 3 * g / l1 * M).det()) != 0


def test_linearisation_accepts_every_equilibrium_and_refuses_other_states(
    double: Derivation,
) -> None:
    upright = double.linearisation((0, sp.pi)).stiffness_matrix
    _, m2, _, l2, g = double.system.params
    assert upright[1, 1] == -g * l2 * m2
    with pytest.raises(
        SystemDefinitionError, match=r"no equilibrium at theta2 = pi/3.*force along theta2"
    ):
        double.linearisation((0, sp.pi / 3))
    with pytest.raises(SystemDefinitionError, match="has 2 coordinates"):
        double.linearisation((0,))


def test_every_step_prints_as_latex(double: Derivation) -> None:
    steps = (
        *double.velocities,
        double.kinetic_energy,
        double.potential_energy,
        double.lagrangian,
        double.momenta,
        double.euler_lagrange,
        double.mass_matrix,
        double.forcing,
        double.accelerations,
        double.hamiltonian,
        *double.hamilton_equations,
        double.energy,
        double.linearisation().stiffness_matrix,
    )
    assert all(step._repr_latex_().startswith("$") for step in steps)
    assert r"\dot{\theta}_{1}" in double.kinetic_energy._repr_latex_()
    assert r"\ddot{\theta}_{2}" in double.euler_lagrange._repr_latex_()
    assert r"p_{\theta_{1}}" in double.hamiltonian._repr_latex_()


a, b, m, length = sp.symbols("a b m length", positive=True)


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        (sp.cos(a) * sp.cos(b) + sp.sin(a) * sp.sin(b), sp.cos(a - b)),
        (m * sp.sin(a) ** 2 + m * sp.cos(a) ** 2, m),
        (m**2 - m**2 * sp.cos(a) ** 2, m**2 * sp.sin(a) ** 2),
        (sp.sin(a) ** 2 * (sp.sin(b) ** 2 + sp.cos(b) ** 2), sp.sin(a) ** 2),
        (m * sp.cos(a), m * sp.cos(a)),
        (m + length, m + length),
    ],
)
def test_reduction_finds_the_shortest_form(expression: sp.Expr, expected: sp.Expr) -> None:
    assert reduced(expression) == expected


def test_collected_keeps_one_term_for_each_function_of_the_state() -> None:
    assert collected(m * sp.sin(a) + length * sp.sin(a) + b, a) == (m + length) * sp.sin(a) + b


def system(**changes: object) -> System:
    x, g = sp.symbols("x g", real=True)
    mass = sp.Symbol("mass", positive=True)
    parts = {
        "name": "thing",
        "title": "A thing",
        "coordinates": [Coordinate(x, "m", "place")],
        "parameters": [Parameter(mass, "kg", 1.0, "mass"), Parameter(g, "m/s^2", 9.8, "gravity")],
        "masses": [PointMass(mass, (x, x**2))],
    }
    return System(**(parts | changes))  # type: ignore[arg-type]


x, y, g = sp.symbols("x y g", real=True)
mass = sp.Symbol("mass", positive=True)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"coordinates": []}, "at least one coordinate"),
        (
            {"masses": [PointMass(mass, (x, y))]},
            r"position of mass mass contains unknown symbols: y",
        ),
        ({"potential": sp.Symbol("k") * x}, "the potential contains unknown symbols: k"),
        (
            {"masses": [PointMass(x, (x, x))]},
            "mass x depends on x: it must be a function of parameters",
        ),
        ({"masses": [PointMass(mass, (x,))]}, "have 1 components"),
        ({"name": "import"}, "'import' cannot be a name"),
        ({"name": "os; rm"}, "cannot be a name"),
        ({"coordinates": [Coordinate(sp.Symbol("volatile"), "m", "")]}, "'volatile' cannot be"),
        (
            {"coordinates": [Coordinate(x, "m", ""), Coordinate(sp.Symbol("x_dot"), "m", "")]},
            "uses a name twice: delta_x_dot, x_dot",
        ),
        ({"parameters": [Parameter(mass, "kg", 1.0, "mass")]}, "no parameter named 'g'"),
        ({"potential": "x**2"}, "'x\\*\\*2' is not a formula"),
        ({"equilibrium": (True,)}, "'True' is not a formula"),
        (
            {"coordinates": [Coordinate(x, "m", ""), Coordinate(sp.Symbol("sin_x"), "m", "")]},
            "uses a name twice: sin_x",
        ),
        ({"name": "hasattr"}, "'hasattr' cannot be"),
        ({"coordinates": [Coordinate(sp.Symbol("thing_real"), "m", "")]}, "cannot be a name"),
    ],
)
def test_a_system_that_cannot_be_derived_is_refused(
    changes: dict[str, object], message: str
) -> None:
    with pytest.raises(SystemDefinitionError, match=message):
        system(**changes)


@pytest.mark.parametrize(
    ("position", "message"),
    [
        ((x, x**2), "'y' of system 'thing' moves no mass"),
        ((x + y, (x + y) ** 2), "only in ways in which x can"),
    ],
)
def test_a_superfluous_coordinate_is_refused(position: tuple[sp.Expr, ...], message: str) -> None:
    redundant = system(
        coordinates=[Coordinate(x, "m", ""), Coordinate(y, "m", "")],
        masses=[PointMass(mass, position)],
    )
    with pytest.raises(SystemDefinitionError, match=message):
        Derivation(redundant)


@pytest.mark.parametrize("first", range(4))
def test_an_inertia_may_be_a_difference_that_is_positive_by_default(first: int) -> None:
    """Parallel axes: the moment J is about the pivot."""
    theta, g = sp.symbols("theta g", real=True)
    J, m, r = sp.symbols("J m r", positive=True)
    values = {J: (0.15, "kg m^2"), m: (1.0, "kg"), r: (0.25, "m"), g: (9.81, "m/s^2")}
    given = [Parameter(s, unit, value, "") for s, (value, unit) in values.items()]
    body = RigidBody(m, (r * sp.sin(theta), -r * sp.cos(theta)), J - m * r**2, theta)
    centred = replace(body, position=(0, 0))
    angle = [Coordinate(theta, "rad", "")]
    for one, expected in ((body, J), (centred, J - m * r**2)):
        system = System("pendulum", "", angle, [*given[first:], *given[:first]], [one])
        assert Derivation(system).mass_matrix[0] == expected
    heavy = [replace(one, default=3.0) if one.symbol == m else one for one in given]
    with pytest.raises(SystemDefinitionError, match="no inertia that is a positive number"):
        Derivation(System("pendulum", "", angle, heavy, [centred]))


def test_three_dimensions_and_a_custom_potential() -> None:
    phi, theta = sp.symbols("phi theta", real=True)
    k, l = sp.symbols("k l", positive=True)  # noqa: E741
    spherical = system(
        coordinates=[Coordinate(theta, "rad", ""), Coordinate(phi, "rad", "")],
        parameters=[
            Parameter(mass, "kg", 1.0, ""),
            Parameter(l, "m", 1.0, ""),
            Parameter(k, "J", 1.0, ""),
        ],
        masses=[
            PointMass(
                mass,
                (
                    l * sp.sin(theta) * sp.cos(phi),
                    l * sp.sin(theta) * sp.sin(phi),
                    -l * sp.cos(theta),
                ),
            )
        ],
        potential=k * theta**2,
    )
    derivation = Derivation(spherical)
    assert derivation.mass_matrix == sp.diag(mass * l**2, mass * l**2 * sp.sin(theta) ** 2)
    assert derivation.potential_energy == k * theta**2


def test_python_numbers_are_formulas_and_exact() -> None:
    bead = system(
        coordinates=[Coordinate(x, "m", "")],
        parameters=[],
        masses=[PointMass(1.5, (x, 0))],
        potential=0,
    )
    assert Derivation(bead).mass_matrix == sp.Matrix([[sp.Rational(3, 2)]])


def test_without_a_known_equilibrium_there_is_no_linear_form() -> None:
    falling = Derivation(system(masses=[PointMass(mass, (0, x))]))
    assert "linear" not in {f.name for f in contents(falling).functions}
    spring = {"potential": (x - 1) ** 2, "gravity": (0, 0), "equilibrium": (1,)}
    assert "linear" in {f.name for f in contents(Derivation(system(**spring))).functions}
    with pytest.raises(SystemDefinitionError, match="no equilibrium at x = 2"):
        contents(Derivation(system(**(spring | {"equilibrium": (2,)}))))


def test_small_motions_on_a_turntable_have_gyroscopic_forces() -> None:
    x, y, turn = sp.symbols("x y turn", real=True)
    c, s = sp.cos(turn * TIME), sp.sin(turn * TIME)
    table = Derivation(
        System(
            name="turntable",
            title="",
            potential=x**2 + y**2,
            coordinates=[Coordinate(x, "m", ""), Coordinate(y, "m", "")],
            parameters=[Parameter(turn, "rad/s", 1.0, "")],
            masses=[PointMass(1, (x * c - y * s, x * s + y * c))],
        )
    )
    assert table.equilibrium == (0, 0)
    names = {f.name for f in contents(table).functions}
    assert "equilibrium" in names
    assert "linear" not in names
    with pytest.raises(SystemDefinitionError, match="have gyroscopic forces"):
        table.linearisation()


def test_missing_gravity_beside_another_potential_is_an_error() -> None:
    with pytest.raises(SystemDefinitionError, match=r"'g' .* not used: .*gravity=\(0, -g\)"):
        system(potential=x**2)
    assert system(potential=x**2, gravity=(0, -g)).potential_energy.has(g)
    with pytest.raises(SystemDefinitionError, match="give the components"):
        PointMass(mass, x)  # type: ignore[arg-type]


@pytest.mark.parametrize(("force", "count"), [
    (lambda q: 2 * q - 3, 1), (lambda q: q**2 - 3, 2), (lambda q: q**2 + 1, 0),
    (lambda q: 2 * sp.sin(q) - 1, 2), (lambda q: sp.cos(q) ** 2 - sp.cos(q), 3),
    (lambda q: sp.sin(q - 1), 2), (lambda q: sp.sin(q) + 2 * sp.cos(q), 2),
    (lambda q: q**3 - q - 1, None), (lambda q: sp.cos(q) - q, None),
    (lambda q: sp.sin(q) ** 3 - sp.sin(q), None),
    (lambda q: sp.sin(q) * sp.cos(q) + sp.cos(q) - 2 * sp.sin(q), None),
    (lambda q: sp.sin(2 * q) + 2 * sp.sin(q) - 1, None),
])  # fmt: skip
def test_roots_of_linear_and_quadratic_forces_have_closed_forms(
    force: Callable[[sp.Symbol], sp.Expr], count: int | None
) -> None:
    factor = force(x)
    if count is None:
        with pytest.raises(SystemDefinitionError, match="no closed form of the equilibria of 'a'"):
            _roots(factor, x, "a")
        return
    roots = _roots(factor, x, "a")
    assert all(sp.simplify(factor.subs(x, root)) == 0 for root in roots)
    assert len({round(float(root) % math.tau, 9) % round(math.tau, 9) for root in roots}) == count
