"""Loops over pairs of different bodies."""

import pytest

from derive.reading.programs.program_reader import read_program
from derive.verification.documents.program_judgement import judge_program

C = """
typedef struct { double m, x, y, vx, vy; } Body;
void step(Body *b, int n, double dt, double G) {
    double ax[n], ay[n];
    for (int i = 0; i < n; i++) {
        ax[i] = 0.0; ay[i] = 0.0;
        for (int j = 0; j < n; j++) {
            CONDITION
            double dx = b[j].x - b[i].x;
            double dy = b[j].y - b[i].y;
            double r = sqrt(dx*dx + dy*dy);
            ax[i] += G * b[j].m * dx / (r*r*r);
            ay[i] += G * b[j].m * dy / (r*r*r);
            END
        }
    }
    for (int i = 0; i < n; i++) {
        b[i].vx += ax[i]*dt; b[i].vy += ay[i]*dt;
        b[i].x += b[i].vx*dt; b[i].y += b[i].vy*dt;
    }
}
"""
SPRINGS = """
def rhs(t, y, m, k):
    n = len(m)
    x, v = y[:n], y[n:]
    a = np.zeros(n)
    for i in range(n):
        for j in range(n):
            if i == j:
                continue
            a[i] += k*(x[j] - x[i])
        a[i] /= m[i]
    return np.concatenate([v, a])
"""


def verdicts(text: str, language: str) -> list[str]:
    formulas = judge_program(read_program(text, language)).formulas
    return [one.verdict for one in formulas if one.latex != "method of integration"]


SKIP = C.replace("CONDITION", "if (i == j) continue;").replace("END", "")


@pytest.mark.long("other tests reach its code")
def test_bodies_attract_others_alone() -> None:
    assert verdicts(SKIP, "C") == ["verified"] * 4
    slip = SKIP.replace("b[j].m * dy / (r*r*r)", "b[j].m * dy / (r*r)")
    assert verdicts(slip, "C") == ["verified", "verified", "wrong", "wrong"]


def test_other_bodies_can_be_chosen_by_a_condition() -> None:
    enclosed = C.replace("CONDITION", "if (j != i) {").replace("END", "}")
    pair = [read_program(text, "C").equations for text in (SKIP, enclosed)]
    first, second = ([one.text for one in equations] for equations in pair)
    assert len(first) == 4
    assert first == second


@pytest.mark.long("other tests reach its code")
def test_what_follows_a_jump_is_for_the_others() -> None:
    assert verdicts(SPRINGS, "Python") == ["verified"] * 2
