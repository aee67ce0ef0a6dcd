"""Chains of pendulums: code stays short and correct as systems grow."""

import random

import numpy as np
import pytest

from derive import Derivation, load
from derive.codegen.module_files import texts
from derive.codegen.module_functions import contents


@pytest.mark.parametrize(("n", "operations"), [(1, 5), (2, 32), (3, 91), (4, 170)])
def test_right_hand_sides_of_chains_are_short(n: int, operations: int) -> None:
    (rhs,) = contents(Derivation(load(f"chain_{n}")), ["rhs"]).functions
    assert rhs.lowering.cost[0] == operations


@pytest.mark.parametrize("n", [3, 5])
def test_generated_chains_solve_the_textbook_equations(n: int) -> None:
    # M_ij = μ l_i l_j cos(θ_i - θ_j), f_i = -Σ μ l_i l_j sin(θ_i - θ_j) θ̇_j² - μ_i g l_i sin θ_i,
    # with μ the mass at or below the lower of the two joints
    namespace: dict[str, object] = {}
    text = texts(Derivation(load(f"chain_{n}")))[f"chain_{n}.py"]
    exec(compile(text, "chain", "exec"), namespace)
    generator = random.Random(n)
    theta, omega = (np.array([generator.uniform(-3, 3) for _ in range(n)]) for _ in range(2))
    m, lengths = (np.array([generator.uniform(0.5, 2) for _ in range(n)]) for _ in range(2))
    below = np.cumsum(m[::-1])[::-1]
    mu = below[np.maximum.outer(np.arange(n), np.arange(n))]
    delta = np.subtract.outer(theta, theta)
    M = mu * np.outer(lengths, lengths) * np.cos(delta)
    f = -(mu * np.outer(lengths, lengths) * np.sin(delta)) @ omega**2
    f -= below * 9.81 * lengths * np.sin(theta)
    params = [*m, *lengths, 9.81]
    rhs, positions = namespace["rhs"], namespace["positions"]
    result = rhs(0.0, [*theta, *omega], params)  # type: ignore[operator]
    np.testing.assert_allclose(result[n:], np.linalg.solve(M, f), rtol=1e-10)
    tip = positions(0.0, [*theta, *omega], params)[-1]  # type: ignore[operator]
    np.testing.assert_allclose(
        tip, (lengths @ np.sin(theta), -(lengths @ np.cos(theta))), atol=1e-12
    )
