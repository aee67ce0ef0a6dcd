"""The simulation of exported files, in the subset of Python that all targets translate.

An exported program consists of these functions, with the constants and the equations of a system in
place of those up to `project`, which are Heun's method for a pendulum as an example. It calls no
mathematical function, so that its results are equal bit for bit wherever numbers are those of IEEE
754 and no two operations are fused; equations that call functions are the exception.

The subset: functions of numbers and vectors with annotations; assignments, loops over `range`,
``while``, ``if``, ``break`` and ``return``; arithmetic, comparisons and calls. A vector that a
function changes is an argument; vectors of its own have a constant length. Variables that are used
after a loop or a condition are assigned before it.
"""

from math import floor, sin, sqrt

Vector = list[float]

# components of the state, parameters, columns of a row of output
SIZE, PARAMETERS, COLUMNS = 2, 1, 5
STAGES, ERROR_ORDER = 2, 1
A = [0.0, 0.0, 1.0, 0.0]
B = [0.5, 0.5]
C = [0.0, 1.0]
# b - b_hat of an embedded solution, and b - b_low of a second one
E = [-0.5, 0.5]
E_LOW = [-0.5, 0.5]
DEFAULTS = [9.81]
START_STATE = [1.0, 0.0]
START_ANGLES = [0.0]
ANGLE_COUNT = 1
DURATION, SAMPLES = 1.0, 10
STEPS = 100
RTOL, ATOL, FIRST_STEP, LEAST_STEP = 1e-6, 1e-6, 0.01, 1e-12
SAFETY_POWER, SHRINK, GROW = 0.81, 0.2, 5.0
TWO_PI, HALF_PI = 6.283185307179586, 1.5707963267948966


def rhs(t: float, y: Vector, params: Vector, result: Vector) -> None:
    """Time derivative of the state."""
    result[0] = y[1]
    result[1] = -params[0] * sin(y[0])


def event(t: float, y: Vector, params: Vector) -> float:
    """Function of the state at whose zeros an event occurs."""
    return y[0]


def is_event(y: Vector, angles: Vector) -> bool:
    """Whether a zero of `event` is an event: the angle may differ by whole turns."""
    return abs(angles[0]) < 1.0


def project(t: float, y: Vector, params: Vector) -> None:
    """Restore sin^2 + cos^2 = 1, and constraints."""


def row(t: float, y: Vector, angles: Vector, params: Vector, values: Vector) -> None:
    """Values of a row of output, after the time."""
    values[0] = y[0]


def print_row(t: float, values: Vector) -> None:
    """Print a row of output, with all digits."""
    print(t, *values, sep=",")


def step(
    t: float, h: float, y: Vector, params: Vector, derivatives: Vector, result: Vector
) -> None:
    """Take a step of size h from y to result; also return the derivatives at the stages."""
    stage = [0.0] * SIZE
    rate = [0.0] * SIZE
    for i in range(STAGES):
        for n in range(SIZE):
            total = 0.0
            for j in range(i):
                total += A[i * STAGES + j] * derivatives[j * SIZE + n]
            stage[n] = y[n] + h * total
        rhs(t + C[i] * h, stage, params, rate)
        for n in range(SIZE):
            derivatives[i * SIZE + n] = rate[n]
    for n in range(SIZE):
        total = 0.0
        for i in range(STAGES):
            total += B[i] * derivatives[i * SIZE + n]
        result[n] = y[n] + h * total
    project(t + h, result, params)


def error_norm(h: float, y: Vector, result: Vector, derivatives: Vector, weights: Vector) -> float:
    """Root mean square of an error estimate of a step, relative to the tolerances."""
    total = 0.0
    for n in range(SIZE):
        error = 0.0
        for i in range(STAGES):
            error += weights[i] * derivatives[i * SIZE + n]
        largest = abs(y[n])
        if abs(result[n]) > largest:
            largest = abs(result[n])
        ratio = h * error / (ATOL + RTOL * largest)
        total += ratio * ratio
    return sqrt(total / float(SIZE))


def combined(first: float, second: float) -> float:
    """The norm of two estimates of an error, the second one of lower order."""
    if first == 0.0:
        return 0.0
    return first * first / sqrt(first * first + 0.01 * second * second)


def step_factor(norm: float) -> float:
    """The factor of the step size after a step with this error norm.

    It is the safety factor times norm**(-1/k) between SHRINK and GROW, to 2 %, by bisection: powers
    of fractions are rounded differently on different machines.
    """
    low = SHRINK
    high = GROW
    for i in range(8):
        factor = 0.5 * (low + high)
        power = norm
        for j in range(ERROR_ORDER + 1):
            power = power * factor
        if power <= SAFETY_POWER:
            low = factor
        else:
            high = factor
    return low


def arctangent(x: float) -> float:
    """The arctangent of a number between 0 and 1, to 2e-16 (atan of fdlibm, Sun Microsystems)."""
    shift = 0.0
    z = x
    if x > 0.6875:
        shift = 0.5 * HALF_PI
        z = (x - 1.0) / (x + 1.0)
    elif x > 0.4375:
        shift = 4.63647609000806093515e-01
        z = (2.0 * x - 1.0) / (2.0 + x)
    square = z * z
    w = square * square
    even = square * (
        3.33333333333329318027e-01
        + w
        * (
            1.42857142725034663711e-01
            + w
            * (
                9.09088713343650656196e-02
                + w
                * (
                    6.66107313738753120669e-02
                    + w * (4.97687799461593236017e-02 + w * 1.62858201153657823623e-02)
                )
            )
        )
    )
    odd = w * (
        -1.99999999998764832476e-01
        + w
        * (
            -1.11111104054623557880e-01
            + w
            * (
                -7.69187620504482999495e-02
                + w * (-5.83357013379057348645e-02 + w * (-3.65315727442169155270e-02))
            )
        )
    )
    return shift + (z - z * (even + odd))


def angle(sine: float, cosine: float, before: float) -> float:
    """The angle of this sine and cosine that is closest to the angle before."""
    less = abs(sine)
    more = abs(cosine)
    is_steep = less > more
    if is_steep:
        less = abs(cosine)
        more = abs(sine)
    value = arctangent(less / more)
    if is_steep:
        value = HALF_PI - value
    if cosine < 0.0:
        value = 2.0 * HALF_PI - value
    if sine < 0.0:
        value = -value
    return value + TWO_PI * floor((before - value) / TWO_PI + 0.5)


def select(s: float, a: float, b: float) -> float:
    """The number a where s > 0, b where s <= 0, and s where it is not a number."""
    if s > 0.0:
        return a
    if s <= 0.0:
        return b
    return s


def factorise(matrix: Vector, n: int) -> None:
    """The factorisation M = L D L^T of a symmetric matrix of n rows, from its upper triangle.

    Reciprocal pivots are on the diagonal, rows of L^T to the right of it.
    """
    for i in range(n):
        inverse = 1.0 / matrix[i * n + i]
        for j in range(i + 1, n):
            ratio = matrix[i * n + j] * inverse
            for k in range(j, n):
                matrix[j * n + k] = matrix[j * n + k] - ratio * matrix[i * n + k]
        matrix[i * n + i] = inverse
        for j in range(i + 1, n):
            matrix[i * n + j] = matrix[i * n + j] * inverse


def solve(matrix: Vector, x: Vector, n: int) -> None:
    """The solution x of M x = b from the factorised matrix M; x is b on entry."""
    for i in range(n):
        for k in range(i + 1, n):
            x[k] = x[k] - matrix[i * n + k] * x[i]
    for i in range(n):
        x[i] = x[i] * matrix[i * n + i]
    for j in range(1, n):
        k = n - j
        for i in range(k):
            x[i] = x[i] - matrix[i * n + k] * x[k]


def follow(y: Vector, angles: Vector) -> None:
    """Let the angles follow the state, over whole turns."""
    angles[0] = angle(y[0], y[1], angles[0])


def locate(
    t: float, h: float, y: Vector, params: Vector, derivatives: Vector, result: Vector
) -> float:
    """The size of the step from y to the event, which is less than h; the state there is returned.

    By the Illinois variant of the false position: a step of each size is taken, so that the event
    has the accuracy of steps.
    """
    low = 0.0
    high = h
    before = event(t, y, params)
    after = event(t + h, result, params)
    part = h
    side = 0
    for k in range(60):
        part = (low * after - high * before) / (after - before)
        if not (low < part and part < high):
            part = 0.5 * (low + high)
        step(t, part, y, params, derivatives, result)
        value = event(t + part, result, params)
        if value == 0.0 or high - low <= 4e-16 * (abs(t) + h):
            break
        if value * after > 0.0:
            high = part
            after = value
            if side == 1:
                before = 0.5 * before
            side = 1
        else:
            low = part
            before = value
            if side == 2:
                after = 0.5 * after
            side = 2
    return part


def print_state(t: float, y: Vector, angles: Vector, params: Vector, kind: float) -> None:
    """Print a row of output for a state."""
    values = [0.0] * COLUMNS
    row(t, y, angles, params, values)
    values[COLUMNS - 1] = kind
    print_row(t, values)


def print_event(
    t: float,
    h: float,
    y: Vector,
    result: Vector,
    angles: Vector,
    params: Vector,
    derivatives: Vector,
) -> None:
    """Print a row for the event in the step of size h from y to result, if there is one."""
    before = event(t, y, params)
    after = event(t + h, result, params)
    if (before < 0.0 and after >= 0.0) or (before > 0.0 and after <= 0.0):
        located = [0.0] * SIZE
        there = [0.0] * ANGLE_COUNT
        for n in range(SIZE):
            located[n] = result[n]
        for n in range(ANGLE_COUNT):
            there[n] = angles[n]
        part = locate(t, h, y, params, derivatives, located)
        follow(located, there)
        if is_event(located, there):
            print_state(t + part, located, there, params, 1.0)


def advance(
    start: float, stop: float, first: float, y: Vector, angles: Vector, params: Vector
) -> float:
    """Advance the state from start to stop by controlled steps; return the size of the next one.

    It is 0 if steps became too small.
    """
    derivatives = [0.0] * (SIZE * STAGES)
    result = [0.0] * SIZE
    t = start
    h = first
    while t < stop:
        part = h
        is_last = t + part >= stop
        if is_last:
            part = stop - t
        step(t, part, y, params, derivatives, result)
        norm = error_norm(part, y, result, derivatives, E)
        norm = combined(norm, error_norm(part, y, result, derivatives, E_LOW))
        factor = step_factor(norm)
        if norm <= 1.0:
            print_event(t, part, y, result, angles, params, derivatives)
            for n in range(SIZE):
                y[n] = result[n]
            follow(y, angles)
            t = t + part
            if is_last:
                t = stop
        if not (norm <= 1.0 and is_last and part * factor < h):
            h = part * factor
        if h < LEAST_STEP:
            return 0.0
    return h


def advance_steps(start: float, stop: float, y: Vector, angles: Vector, params: Vector) -> None:
    """Advance the state from start to stop by STEPS equal steps."""
    derivatives = [0.0] * (SIZE * STAGES)
    result = [0.0] * SIZE
    h = (stop - start) / float(STEPS)
    for k in range(STEPS):
        t = start + h * float(k)
        step(t, h, y, params, derivatives, result)
        print_event(t, h, y, result, angles, params, derivatives)
        for n in range(SIZE):
            y[n] = result[n]
        follow(y, angles)


def simulate() -> bool:
    """Integrate and print the motion; false if steps became too small."""
    y = [0.0] * SIZE
    angles = [0.0] * ANGLE_COUNT
    params = [0.0] * PARAMETERS
    h = FIRST_STEP
    for n in range(SIZE):
        y[n] = START_STATE[n]
    for n in range(ANGLE_COUNT):
        angles[n] = START_ANGLES[n]
    for n in range(PARAMETERS):
        params[n] = DEFAULTS[n]
    print_state(0.0, y, angles, params, 0.0)
    for k in range(SAMPLES):
        start = DURATION * float(k) / float(SAMPLES)
        stop = DURATION * float(k + 1) / float(SAMPLES)
        h = advance(start, stop, h, y, angles, params)
        if h == 0.0:
            return False
        advance_steps(start, stop, y, angles, params)
        print_state(stop, y, angles, params, 0.0)
    return True
