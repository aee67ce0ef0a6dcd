"""Documents of our own making: derivations of random systems, right or with one slip."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from random import Random
from typing import Any

import sympy as sp
from document_styles import COMMON, Style
from treated_systems import FAMILIES, treated_system

from derive.formulas.expression import FUNCTIONS, parse
from derive.mechanics.derivation import Derivation
from derive.reading.latex.display_reader import formulas
from derive.reading.latex.tree import Statement
from derive.system.rigid_body import RigidBody
from derive.verification.documents.formula_translation import FormulaTranslator
from derive.verification.documents.statements import LetterNotation

#: Characters of the longest side that is written.
LONGEST = 320
FUNCTION = re.compile(
    r"\\(sin|cos|log|tan)(\^\{\d\})?\{\\left\(((?:[^()]|\([^()]*\))*?) \\right\)\}"
)
ACCENT = re.compile(r"\\(d?dot)\{([^{}]+)\}(\^\{\d\})?")
INDEXED = re.compile(r"\\(d?dot)\{([^{}]+)_(\d)\}")


#: A Lagrangian in script, and another letter for it, which differs from a length L.
SCRIPT = (r"\mathcal{L}", r"\Lambda")
#: Letters of abbreviations, and what they stand for.
ABBREVIATIONS = {
    "inertia": ("K", "l**2*m"),
    "total": ("M", "m1 + m2"),
    "difference": (r"\Delta", "theta1 - theta2"),
}
#: Equal forms of a formula.
FORMS = (sp.expand, sp.factor, sp.together, sp.trigsimp, sp.simplify, lambda one: one)


@dataclass(frozen=True)
class WrittenDocument:
    """A right document, with the values of its letters."""

    style: Style
    derivation: Derivation
    steps: tuple[tuple[str, tuple[str, ...]], ...]
    names: Mapping[str, Any]  # as a reader has them
    parameters: tuple[str, ...]  # their letters

    @property
    def statements(self) -> tuple[str, ...]:
        """The statements in their order."""
        return tuple(one for _, found in self.steps for one in found)

    def text(self, changed: Mapping[str, str] = {}) -> str:
        """The text, with some statements changed."""
        steps = [(step, [changed.get(one, one) for one in found]) for step, found in self.steps]
        return self.style.written(steps)

    def is_right(self, latex: str) -> bool | None:
        """Whether all sides of a statement are equal; None if it cannot be read."""
        statement = next(iter(formulas(latex.replace(*SCRIPT))), None)
        if not isinstance(statement, Statement) or len(statement.sides) < 2:
            return None
        translator = FormulaTranslator(self._notation)
        try:
            texts = [translator.text(side).text for side in statement.sides]
            partials = {
                name: self.names[operand].diff(*(self.names[one] for one in variables))
                for name, (operand, variables) in translator.derivatives.items()
            }
            scope = {**FUNCTIONS, "ddt": self._rate, **self.names, **partials}
            first, *others = (self._numbers(parse(text, scope)) for text in texts)
        except (ValueError, KeyError, TypeError, AttributeError):
            return None
        pairs = (pair for other in others for pair in zip(first, other, strict=True))
        return all(abs(a - b) < 1e-9 * (1 + abs(a)) for a, b in pairs)

    @cached_property
    def _notation(self) -> LetterNotation:
        system = self.derivation.system
        moving = {n for n, v in self.names.items() if v in (*system.q, *system.qdot, *system.qddot)}
        times = frozenset(moving if self.style.rates == "time" else ())
        return LetterNotation(times, times, primes_are_rates=self.style.rates == "prime")

    def _rate(self, value: sp.Expr) -> sp.Expr:
        system, d = self.derivation.system, self.derivation
        value = value.xreplace(dict(zip(system.p, d.momenta, strict=True)))
        pairs = zip((*system.q, *system.qdot), (*system.qdot, *system.qddot), strict=True)
        return sp.Add(*(value.diff(q) * v for q, v in pairs))

    def _numbers(self, value: sp.Expr) -> list[float]:
        return [complex(value.xreplace(one).evalf(30)).real for one in self._states]

    @cached_property
    def _states(self) -> list[dict[sp.Symbol, sp.Expr]]:
        """Values of all symbols on motions."""
        system, d, pick = self.derivation.system, self.derivation, Random(0)
        states = []
        for _ in range(3):
            given = (*system.params, *system.q, *system.qdot)
            state = {one: sp.Float(pick.uniform(0.4, 1.4), 30) for one in given}
            for symbols, values in ((system.qddot, d.accelerations), (system.p, d.momenta)):
                state |= {
                    one: value.xreplace(state).evalf(30)
                    for one, value in zip(symbols, values, strict=True)
                }
            states.append(state)
        return states


def written_document(style: Style, seed: int) -> WrittenDocument | None:
    """A document in a style about a random system; None if the style does not suit it."""
    pick = Random(seed)
    family = FAMILIES[seed % len(FAMILIES)]
    writer = _Writer(style, Derivation(treated_system(family, pick, style.shift)), seed)
    letters = [*writer.letters.values(), *style.energies]
    steps = [(step, tuple(getattr(writer, step)())) for step in style.steps]
    steps = [(step, found) for step, found in steps if found]
    if len({*letters}) < len(letters) or max(len(one) for _, f in steps for one in f) > LONGEST:
        return None
    parameters = tuple(writer.letters[one] for one in writer.d.system.params)
    return WrittenDocument(style, writer.d, tuple(steps), writer.names(), parameters)


class _Writer:
    """The formulas of each step."""

    def __init__(self, style: Style, derivation: Derivation, seed: int) -> None:
        self._style, self.d, self._system = style, derivation, derivation.system
        self._forms = Random(seed)
        table = {**COMMON, **style.letters}
        own = (*self._system.q, *self._system.params)
        self.letters = {one: table.get(one.name, one.name) for one in own}
        for q, v, a in zip(own, self._system.qdot, self._system.qddot, strict=False):
            self.letters |= {v: rf"\dot{{{self.letters[q]}}}", a: rf"\ddot{{{self.letters[q]}}}"}
        for q, p in zip(own, self._system.p, strict=False):
            self.letters[p] = f"p_{{{self.letters[q]}}}"
        self._short: dict[sp.Expr, sp.Symbol] = {}
        for kind in style.abbreviated:
            letter, text = ABBREVIATIONS[kind]
            whole = sp.sympify(text, {one.name: one for one in own})
            if whole.free_symbols <= {*own}:
                self._short[whole] = sp.Symbol(f"abbreviation_{kind}", real=True)
                self.letters[self._short[whole]] = letter
        points = [mass.position for mass in self._system.masses]
        self._axes = "xyz" if not {"x", "y"} & {*self.letters.values()} else "XYZ"
        self._points = {
            self._axes[k] + (f"_{i}" if len(points) > 1 else ""): self._seen(point, k)
            for i, point in enumerate(points, 1)
            for k in range(len(point))
        }

    def names(self) -> dict[str, Any]:
        """The values of the names that a reader has for the letters."""
        d, translator = self.d, FormulaTranslator()
        T, V, L, H = self._style.energies
        values: dict[str, Any] = {latex: one for one, latex in self.letters.items()}
        values |= {self.letters[short]: whole for whole, short in self._short.items()}
        values |= {T: d.kinetic_energy, V: d.potential_energy, L: d.lagrangian}
        values |= {H: d.hamiltonian, "E": d.energy, **self._points}
        values |= {self._dotted(name): self._rate(e) for name, e in self._points.items()}
        forces = [d.lagrangian.diff(q) for q in self._system.q]
        for p, force in zip(self._system.p, forces, strict=True):
            values[rf"\dot{{{self.letters[p]}}}"] = force
        return {translator.text(_letter(latex)).text: value for latex, value in values.items()}

    def _seen(self, point: Sequence[sp.Expr], axis: int) -> sp.Expr:
        is_height = axis == len(point) - 1
        return sp.expand(-point[axis]) if is_height and self._style.is_down else point[axis]

    def abbreviations(self) -> Iterator[str]:
        for whole, short in self._short.items():
            yield f"{self.letters[short]} = {self._latex(whole, short=False)}"

    def positions(self) -> Iterator[str]:
        rigid = any(isinstance(mass, RigidBody) for mass in self._system.masses)
        still = any(not any(mass.position) for mass in self._system.masses)
        if not (rigid or still):
            yield from (f"{name} = {self._latex(e)}" for name, e in self._points.items() if e != 0)

    def velocities(self) -> Iterator[str]:
        if [*self.positions()]:
            for name, e in self._points.items():
                if e != 0 and e not in self._system.q:
                    yield f"{self._restyled(self._dotted(name))} = {self._latex(self._rate(e))}"

    def kinetic(self) -> Iterator[str]:
        yield f"{self._style.energies[0]} = {self._latex(self.d.kinetic_energy)}"

    def potential(self) -> Iterator[str]:
        if self.d.potential_energy != 0:
            yield f"{self._style.energies[1]} = {self._latex(self.d.potential_energy)}"

    def lagrangian(self) -> Iterator[str]:
        T, V, L, _ = self._style.energies
        middle = f"{T} - {V} = " if self._style.is_chained and self.d.potential_energy != 0 else ""
        yield f"{L} = {middle}{self._latex(self.d.lagrangian)}"

    def partials(self) -> Iterator[str]:
        L = self._style.energies[2]
        for one in (
            s for pair in zip(self._system.q, self._system.qdot, strict=True) for s in pair
        ):
            value = self._latex(self.d.lagrangian.diff(one))
            yield rf"\frac{{\partial {L}}}{{\partial {self._latex(one)}}} = {value}"

    def rates(self) -> Iterator[str]:
        L = self._style.energies[2]
        for v, p in zip(self._system.qdot, self.d.momenta, strict=True):
            left = rf"\frac{{d}}{{dt}} \frac{{\partial {L}}}{{\partial {self._latex(v)}}}"
            yield f"{left} = {self._latex(self._rate(p))}"

    def equations(self) -> Iterator[str]:
        for equation in self.d.euler_lagrange:
            terms = sp.Add.make_args(sp.expand(equation))
            right = [t for t in terms if not t.has(*self._system.qddot)]
            moved = right if self._style.moves_right else []
            left = equation - sp.Add(*moved)
            yield f"{self._latex(left)} = {self._latex(-sp.Add(*moved))}"

    def accelerations(self) -> Iterator[str]:
        for a, value in zip(self._system.qddot, self.d.accelerations, strict=True):
            yield f"{self._latex(a)} = {self._latex(value)}"

    def momenta(self) -> Iterator[str]:
        for p, value in zip(self._system.p, self.d.momenta, strict=True):
            yield f"{self._latex(p)} = {self._latex(value)}"

    def hamiltonian(self) -> Iterator[str]:
        yield f"{self._style.energies[3]} = {self._latex(self.d.hamiltonian)}"

    def canonical(self) -> Iterator[str]:
        H, q = self.d.hamiltonian, self._system.q
        for one, v, p in zip(q, self._system.qdot, self._system.p, strict=True):
            yield f"{self._latex(v)} = {self._latex(H.diff(p))}"
            rate = self._restyled(self._dotted(self.letters[p]))
            yield f"{rate} = {self._latex(-H.diff(one))}"

    def energy(self) -> Iterator[str]:
        yield f"E = {self._latex(self.d.energy)}"

    def _rate(self, value: sp.Expr) -> sp.Expr:
        s = self._system
        pairs = zip((*s.q, *s.qdot), (*s.qdot, *s.qddot), strict=True)
        return sp.Add(*(value.diff(q) * v for q, v in pairs))

    @staticmethod
    def _dotted(letter: str) -> str:
        return rf"\dot{{{letter}}}"

    def _latex(self, value: sp.Expr, short: bool = True) -> str:
        if self._style.is_rearranged:
            form = self._forms.choice(FORMS)(value)
            value = form if sp.count_ops(form) <= 2 * sp.count_ops(value) else value
        if short:
            for whole, letter in self._short.items():
                value = value.subs(whole, letter)
        plain = {one: sp.Symbol(one.name, real=True) for one in self.letters}
        letters = {plain[one]: latex for one, latex in self.letters.items()}
        text = sp.latex(
            value.xreplace(plain), symbol_names=letters, mul_symbol=self._style.times,
            long_frac_ratio=0.1 if self._style.halves else None,
        )  # fmt: skip
        return self._restyled(text)

    def _restyled(self, text: str) -> str:
        """Formulas of SymPy in the notation of the style."""
        own = r"\\\1\2(\3)" if self._style.brackets else r"\\\1\2 \3"

        def function(found: re.Match[str]) -> str:
            is_letter = found[3] in self.letters.values()
            return found.expand(own if is_letter else r"\\\1\2(\3)")

        text = FUNCTION.sub(function, text.replace(r"\log", r"\ln"))
        moving = sorted((self.letters[q] for q in self._system.q), key=len, reverse=True)
        match self._style.rates:
            case "time":
                names = "|".join(map(re.escape, moving))
                pattern = rf"(\\d?dot\{{(?:{names})\}}|(?<![\w\\])(?<!_\{{)(?:{names})(?![\w_]))"
                return re.sub(pattern, r"\1(t)", text)
            case "leibniz":
                return ACCENT.sub(_leibniz, text)
            case "prime":
                return ACCENT.sub(_prime, text)
        return text if self._style.brackets else INDEXED.sub(r"\\\1{\2}_\3", text)


def _leibniz(found: re.Match[str]) -> str:
    order = "^2" if found[1] == "ddot" else ""
    text = rf"\frac{{d{order} {found[2]}}}{{dt{order}}}"
    return rf"\left({text}\right){found[3]}" if found[3] else text


def _prime(found: re.Match[str]) -> str:
    letter, _, index = found[2].partition("_")
    text = f"{letter}{'' if not index else f'_{index}'}" + "'" * found[1].count("d")
    return f"({text}){found[3]}" if found[3] else text


def _letter(latex: str) -> Any:
    statement = next(iter(formulas(f"{latex} = 0".replace(*SCRIPT))))
    assert isinstance(statement, Statement)
    return statement.sides[0]
