"""Functions and constants of mathematics, as languages and libraries name them."""

from derive.reading.programs.syntax.trees import (
    Expression,
    FunctionCall,
    Name,
    NumberLiteral,
    Opaque,
    OperatorExpression,
)

#: Names before a function, such as math.sin and std::sin.
LIBRARIES = {
    "", "np", "numpy", "math", "Math", "std", "jnp", "cmath", "mp", "sp", "sympy", "torch", "tf",
    "cp", "onp", "npx", "Base", "jnp.numpy", "p5", "p", "this", "self", "sketch", "onp.numpy",
    "StrictMath", "FastMath",
}  # fmt: skip
#: Functions of one argument, and their names in formulas.
FUNCTIONS = {name: name for name in ("sin", "cos", "tan", "exp", "log", "sqrt")}
FUNCTIONS |= {f"{name}{suffix}": name for name in FUNCTIONS for suffix in ("f", "l")}
FUNCTIONS |= {f"d{name}": name for name in ("sin", "cos", "tan", "exp", "log", "sqrt")}
FUNCTIONS |= {"ln": "log"}
#: Functions that are methods of numbers, as in ``x.sin()`` of Rust.
METHODS = {"sin", "cos", "tan", "exp", "ln", "sqrt", "powi", "powf", "pow", "abs", "hypot", "recip"}
METHODS |= {"sin_cos", "to_radians", "to_degrees", "mul_add", "atan2", "signum", "clamp"}
#: Functions that convert degrees to radians.
TO_RADIANS = ("radians", "deg2rad", "toRadians", "to_radians")
#: Functions whose argument is in degrees.
DEGREES = {"sind": "sin", "cosd": "cos", "tand": "tan"}
#: Functions that return their argument, or change nothing but its type.
IDENTITIES = {
    "float", "double", "Number", "parseFloat", "real", "float64", "Float64", "real64", "dble",
    "Real", "static_cast", "copy", "deepcopy", "squeeze", "ravel", "flatten", "asarray", "array",
    "matrix", "Vector", "collect", "vec", "tolist", "SVector", "MVector", "SA", "list", "tuple",
    "vector", "Matrix", "atleast_1d", "Vector2d", "Vector3d", "Vector4d", "VectorXd", "state_type",
    "float32", "copyOf", "ArrayRealVector", "Vector2", "Vector3", "Vector4", "Vec2", "Vec3", "Ok",
}  # fmt: skip
PI = {"pi", "PI", "M_PI", "π", "Pi", "M_PIl"}
MULTIPLES = {"TWO_PI": "2", "TAU": "2", "HALF_PI": "0.5", "M_PI_2": "0.5"}
MULTIPLES |= {"QUARTER_PI": "0.25", "M_PI_4": "0.25"}
#: Without a library before it, tau is a torque.
MULTIPLES |= {"math.tau": "2", "cmath.tau": "2"}


def split(path: str) -> tuple[str, str]:
    """The library and the name of a path such as ``np.sin``."""
    library, _, name = path.rpartition(".")
    if library == "math":  # Go has capital letters
        name = name[:1].lower() + name[1:]
    return library, name


def constant(line: int, path: str) -> Expression | None:
    """The value of the name of a constant; None for other names."""
    library, name = split(path)
    if library not in LIBRARIES:
        return None
    if name in PI:
        return Name(line, "pi")
    if multiple := MULTIPLES.get(path) or MULTIPLES.get(name):
        return OperatorExpression(line, "*", (NumberLiteral(line, multiple), Name(line, "pi")))
    return None


def applied(line: int, path: str, arguments: tuple[Expression, ...]) -> Expression | None:
    """The value of a function of mathematics; None for other functions."""
    library, name = split(path)
    if library not in LIBRARIES:
        return None
    match name, arguments:
        case _, (x,) if name in FUNCTIONS:
            return FunctionCall(line, Name(line, FUNCTIONS[name]), (x,))
        case _, (x,) if name in DEGREES:
            return FunctionCall(line, Name(line, DEGREES[name]), (radians(line, x),))
        case "cot" | "sec" | "csc", (x,):
            sine, cosine = (FunctionCall(line, Name(line, one), (x,)) for one in ("sin", "cos"))
            above = cosine if name == "cot" else NumberLiteral(line, "1")
            return OperatorExpression(line, "/", (above, cosine if name == "sec" else sine))
        case _, (x,) if name in TO_RADIANS:
            return radians(line, x)
        case "degrees" | "rad2deg" | "toDegrees" | "to_degrees", (x,):
            return OperatorExpression(line, "*", (x, _ratio(line, "180", "pi")))
        case "recip", (x,):
            return OperatorExpression(line, "/", (NumberLiteral(line, "1"), x))
        case "mul_add", (x, factor, term):
            return OperatorExpression(line, "+", (OperatorExpression(line, "*", (x, factor)), term))
        case "pow" | "power" | "powf" | "powi" | "float_power", (x, exponent):
            return OperatorExpression(line, "**", (x, exponent))
        case "clip" | "constrain" | "clamp", (x, _, _):
            return x  # equations hold within the limits
        case "square" | "sq" | "abs2", (x,):
            return OperatorExpression(line, "**", (x, NumberLiteral(line, "2")))
        case "sign" | "signum" | "abs" | "fabs" | "atan2" | "asin" | "acos" | "atan", _:
            return Opaque(line, f"the function {name} is not among those of formulas")
    return None


def radians(line: int, x: Expression) -> Expression:
    """An angle in degrees, in radians."""
    return OperatorExpression(line, "*", (x, _ratio(line, "pi", "180")))


def _ratio(line: int, above: str, below: str) -> Expression:
    parts = [Name(line, one) if one == "pi" else NumberLiteral(line, one) for one in (above, below)]
    return OperatorExpression(line, "/", tuple(parts))
