"""Generalized forces as a linear function of base parameters, found by exact arithmetic.

The forces M q̈ - f of a motion are linear in products of parameters such as m l² and m g l. Columns
of these products that depend on each other are merged, so that the remaining ones are independent
functions of the motion (M. Gautier, W. Khalil, IEEE Transactions on Robotics and Automation 6
(1990) 368-373, for robots). Products of coordinates, velocities, accelerations, and sines and
cosines of angles are independent but for sin² + cos² = 1, so that dependencies are found among
their coefficients, by exact arithmetic. Other functions count as independent.
"""

from collections.abc import Iterable, Sequence, Set
from dataclasses import dataclass

import sympy as sp
from sympy.polys.matrices import DomainMatrix

from derive.mechanics.energies.kinetics import Matrix


@dataclass(frozen=True)
class Regressor:
    """The generalized forces that a motion needs, M q̈ - f = Y π, where inputs are 0.

    Attributes
    ----------
    matrix : sympy.ImmutableDenseMatrix
        Y, one row for each coordinate: functions of q, q̇, q̈ and time, of inputs that are prescribed
        motions, and of parameters in which forces are not linear, such as a driving frequency.
    parameters : sympy.ImmutableDenseMatrix
        Base parameters π, a column: combinations of the other parameters, as few as there are
        independent columns of Y; 1 for terms without parameters.

    Examples
    --------
    >>> from derive import Derivation, load
    >>> arm = Derivation(load("two_link_arm"))
    >>> for parameter in arm.regressor.parameters:
    ...     print(parameter)
    I1 + c1**2*m1 + l1**2*m2
    I2 + c2**2*m2
    g*(c1*m1 + l1*m2)
    c2*g*m2
    c2*l1*m2
    """

    matrix: Matrix
    parameters: Matrix


def regressor(forces: Sequence[sp.Expr], parameters: Iterable[sp.Symbol]) -> Regressor:
    """Y and π of these forces, which are linear in products of the parameters."""
    expanded = [sp.Add.make_args(sp.expand(force)) for force in forces]
    factors = {f for terms in expanded for term in terms for f in sp.Mul.make_args(term)}
    constants, known = {*parameters}, set[sp.Symbol]()
    for factor in factors:
        if not factor.free_symbols <= constants:  # it depends on the motion, too
            known |= factor.free_symbols & constants
    columns: dict[sp.Expr, list[list[sp.Expr]]] = {}
    for i, terms in enumerate(expanded):
        for term in terms:
            product, rest = _separated(term, constants - known)
            columns.setdefault(product, [[] for _ in forces])[i].append(rest)
    products = sorted(columns, key=sp.default_sort_key)
    sums = [[sp.Add(*terms) for terms in columns[product]] for product in products]
    reduced, pivots = _independent(sums, known)
    base = [
        sp.factor_terms(sp.Add(*(a * product for a, product in zip(row, products, strict=True))))
        for row in reduced
    ]
    entries = [sums[k][i] for i in range(len(forces)) for k in pivots]
    return Regressor(Matrix(len(forces), len(pivots), entries), Matrix(base))


def _separated(term: sp.Expr, symbols: Set[sp.Symbol]) -> tuple[sp.Expr, sp.Expr]:
    """The product of the factors that contain none but these symbols, and the other factors."""
    own = [f for f in sp.Mul.make_args(term) if f.free_symbols and f.free_symbols <= symbols]
    product = sp.Mul(*own)
    return product, term / product


def _independent(
    columns: Sequence[Sequence[sp.Expr]], known: Set[sp.Symbol]
) -> tuple[list[list[sp.Expr]], list[int]]:
    """Coefficients of all columns in independent ones, in rows, and the indices of these."""
    rows: dict[tuple[int, sp.Expr], list[sp.Expr]] = {}
    for k, column in enumerate(columns):
        for i, function in enumerate(column):
            for term in sp.Add.make_args(_normal_form(function)):
                number, rest = term.as_coeff_Mul(rational=True)
                coefficient, wave = _separated(rest, known)
                row = rows.setdefault((i, wave), [sp.S.Zero] * len(columns))
                row[k] += number * coefficient
    matrix = DomainMatrix.from_Matrix(sp.Matrix([*rows.values()]))
    reduced, pivots = matrix.to_field().rref()
    return reduced.to_Matrix()[: len(pivots), :].tolist(), list(pivots)


def _normal_form(function: sp.Expr) -> sp.Expr:
    """A sum of products in which angles occur alone and sines have no powers."""
    expanded = sp.expand(sp.expand_trig(function)).replace(
        lambda e: e.is_Pow and isinstance(e.base, sp.sin) and e.exp.is_Integer and e.exp > 1,
        lambda e: (1 - sp.cos(e.base.args[0]) ** 2) ** (e.exp // 2) * e.base ** (e.exp % 2),
    )
    return sp.expand(expanded)
