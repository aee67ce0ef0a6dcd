"""The report's three Mathematica programs: the equations that each solves, and its errors.

Formulas are retyped in the language of `derive.formulas.expression`; of the program text,
which character recognition can distort, only lines that show an error are quoted.
"""

import re
from dataclasses import asdict, dataclass

import sympy as sp

from derive.formulas.expression import parse
from derive.formulas.zero import vanishes
from derive.verification.report.contexts import double_pendulum

OPENING = {"]": "[", "}": "{", ")": "("}


@dataclass(frozen=True)
class ReportScene:
    """A motion; by default that of chapters 3 to 5, with the velocities of program 1."""

    masses: tuple[sp.Expr, ...] = (sp.S(1), sp.S(1))  # kg
    lengths: tuple[sp.Expr, ...] = (sp.S(2), sp.S(2))  # m
    gravity: sp.Expr = sp.S(981) / 100  # m/s^2
    angles: tuple[sp.Expr, ...] = (sp.pi / 2, sp.pi)  # rad
    velocities: tuple[sp.Expr, ...] = (sp.S(0), sp.S(0))  # rad/s
    duration: int = 5  # s

    @property
    def differences(self) -> tuple[str, ...]:
        """The values that differ from those of the prose."""
        pairs = zip(asdict(self).items(), asdict(PROSE).values(), strict=True)
        differing = [(name, own, stated) for (name, own), stated in pairs if own != stated]
        return tuple(f"{n}: {sp.sstr(a)} instead of {sp.sstr(b)}" for n, a, b in differing)


#: The values that the chapters state for all programs.
PROSE = ReportScene()


@dataclass(frozen=True)
class ReportProgram:
    """A program, the equations that it solves, and its errors."""

    id: str
    title: str
    solves: str
    scene: ReportScene
    stops: tuple[str, ...]  # errors that prevent it from running as printed
    differs: tuple[str, ...]  # contradictions to the prose, or within the program


def programs() -> list[ReportProgram]:
    """Analyse all three programs."""
    return [_first(), _second(), _third()]


def _first() -> ReportProgram:
    equations = (
        "2*theta1_ddot + theta2_ddot*cos(theta1 - theta2)"
        " + theta2_dot**2*sin(theta1 - theta2) + 2*9.81*sin(theta1)",
        "theta2_ddot + theta1_ddot*cos(theta1 - theta2)"
        " - theta1_dot**2*sin(theta1 - theta2) + 9.81*sin(theta2)",
    )
    call = "NDSolve[ { ..., theta2'[0] == 0, {theta1[t], theta2[t], t}, {t, 0, 5} ]"
    length = _length_solved(equations)
    scene = ReportScene(lengths=(length, length))
    stops = [_bracket_fault(call)]
    *_, unknowns, interval = re.findall(r"{([^{}]*)}", call)
    if interval.split(",")[0] in unknowns.split(", "):
        stops.append("it passes the time itself to NDSolve as an unknown")
    title = "Appendix B, figure 1: Lagrangian"
    solves = f"the Euler-Lagrange equations of equal masses on rods of {length} m"
    return ReportProgram("program1", title, solves, scene, tuple(stops), scene.differences)


def _second() -> ReportProgram:
    # the Lagrangian from the program's positions
    x1, y1 = "(l1*sin(phi1))", "(-l1*cos(phi1))"
    x2, y2 = f"({x1} + l2*sin(phi2))", f"({y1} - l2*cos(phi2))"
    lagrangian = (
        f"m1/2*(ddt({x1})**2 + ddt({y1})**2) + m2/2*(ddt({x2})**2 + ddt({y2})**2)"
        f" - g*(m1*{y1} + m2*{y2})"
    )
    correct = double_pendulum(moving=False).check(f"L = {lagrangian}").holds
    text = "sol = First[NDSolve[...]]; x1[t] := Sin[phi1[t]] /. sol2; ... Plot[... /. sol, ...]"
    scene = ReportScene(velocities=(sp.pi, 2 * sp.pi))
    differs = list(scene.differences)
    for name in sorted(set(re.findall(r"/\. (\w+)", text))):  # solutions that are used
        if not re.search(rf"\b{name} =", text):
            needed = f"the coordinates of the bobs need {name}, which is never assigned"
            differs.append(f"{needed}; no plot uses them")
    differs.append("these coordinates omit the lengths, as for rods of 1 m")
    differs.append("its last plot shows phi2 over phi1, not a path of the bobs")
    title = "Appendix B, figure 2: Euler-Lagrangian"
    solves = f"the Euler-Lagrange equations of {'the correct' if correct else 'a wrong'} Lagrangian"
    return ReportProgram("program2", title, solves, scene, (), tuple(differs))


def _third() -> ReportProgram:
    f3 = (
        "(-g*(2*m1 + m1)*sin(theta1) - m2*g*sin(theta1 - 2*theta2)"
        " - 2*sin(theta1 - theta2)*m2*(theta2_dot**2*l2"
        " + theta1_dot**2*l1*cos(theta1 - theta2)))"
        "/(l1*(2*m1 + m2 - m2*cos(2*theta1 - 2*theta2)))"
    )
    f4 = (
        "2*sin(theta1 - theta2)*(theta1_dot**2*l1*(m1 + m2) + g*(m1 + m2)*cos(theta1)"
        " + theta2_dot**2*l2*m2*cos(theta1 - theta2))"
        "/(l2*(2*m1 + m2 - m2*cos(2*theta1 - 2*theta2)))"
    )
    loop = (
        "f1[t_, ...] := y; f2[t_, ...] := v; f3[t_, ...] := ...; f4[t_, ...] := ...; Do["
        " {f1, k1, l1, m1} = Map[#][t, ...] &, {f1, f2, f3, f4}];"
        " {f2, k2, l2, m2} = Map[#][..., x + h/2 * j1, ...] &, {f1, f2, f3, f4}];"
        " {f3, k3, l3, m3} = Map[#][..., x + h/2 * j2, ...] &, {f1, f2, f3, f4}];"
        " {f4, k4, l4, m4} = Map[#][..., x + h * j3, ...] &, {f1, f2, f3, f4}];"
        " x = x + h * (j1 + 2 * j2 + 2 * j3 + j4) / 6; ... {...}], {i, 1, n}]"
    )
    assigned = re.findall(r"\{(\w+), \w+, \w+, \w+\} =", loop)
    functions = set(re.findall(r"(\w+)\[t_", loop))
    needed = sorted(set(re.findall(r"\bj\d", loop)) - set(assigned))
    scene = ReportScene(angles=(sp.S(0), -sp.pi / 4), duration=50)
    title = "Appendix B, figures 3 and 4: Runge-Kutta"
    solves = (
        f"accelerations: the first {_agreement('theta1_ddot', f3)}, the second "
        f"{_agreement('theta2_ddot', f4)}; 5000 steps of the classical fourth-order method, "
        "h = 0.01 s"
    )
    stops = (
        _bracket_fault(loop),
        f"it assigns to its functions {', '.join(n for n in assigned if n in functions)}",
        f"it never assigns to {', '.join(needed)}, which it needs",
    )
    orders = (
        "it has the fourth-order method only, and eight plots of this one run: if the figures "
        "RK1 to RK4 show methods of these orders, no program computes three of them"
    )
    return ReportProgram("program3", title, solves, scene, stops, (*scene.differences, orders))


def _length_solved(equations: tuple[str, ...]) -> sp.Expr:
    """The common length of the rods for which `equations` agree with the derivation."""
    namespace = double_pendulum(moving=False).namespace
    length = sp.Symbol("length", positive=True)
    values = {namespace[f"m{i}"]: m for i, m in enumerate(PROSE.masses, 1)}
    values |= {namespace["l1"]: length, namespace["l2"]: length, namespace["g"]: PROSE.gravity}
    lengths = [
        set(
            sp.solve(
                parse(text, namespace) - sp.expand(namespace[name].subs(values) / length**2), length
            )
        )
        for text, name in zip(equations, ("E1", "E2"), strict=True)
    ]
    (common,) = set.intersection(*lengths)
    return common


def _agreement(name: str, formula: str) -> str:
    """How a program's formula agrees with a derived acceleration."""
    context = double_pendulum(moving=True)
    if context.check(f"{name} = {formula}").holds:
        return "is correct"
    derived = context.substitutions[-1][context.namespace[name]]
    difference = parse(formula, context.namespace) - derived
    if vanishes(difference.subs(context.namespace["m2"], context.namespace["m1"])):
        return "is correct for equal masses only (2 m1 + m1 stands for 2 m1 + m2)"
    return "is wrong"


def _bracket_fault(text: str) -> str:
    """Describe the first unbalanced bracket of `text`; empty if all are balanced."""
    opened: list[tuple[str, int]] = []
    for index, letter in enumerate(text):
        if letter in OPENING.values():
            opened.append((letter, index))
        elif letter in OPENING:
            if not opened:
                return f"unmatched {letter!r} after: ...{text[:index][-40:]}"
            bracket, start = opened.pop()
            if bracket != OPENING[letter]:
                return f"the {bracket!r} after {text[:start].strip()!r} is never closed"
    return f"the {opened[-1][0]!r} at index {opened[-1][1]} is never closed" if opened else ""
