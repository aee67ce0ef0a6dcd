"""Random trees of formulas, written in LaTeX in one of many spellings."""

from random import Random

from hypothesis import strategies as st

from derive.reading.latex.tree import (
    Application,
    Call,
    Derivative,
    Letter,
    Matrix,
    Node,
    Number,
    Power,
    Product,
    Quotient,
    Root,
    Sum,
    Tuple,
)

AT = (0, 0)
GREEK = ("theta", "omega", "phi")
LATIN = ("m", "g", "l", "x", "y", "q")

numbers = st.sampled_from(["2", "3", "12", "9.81"]).map(lambda digits: Number(digits, AT))
letters = st.builds(
    Letter,
    st.sampled_from(GREEK + LATIN),
    st.just(AT),
    st.sampled_from(["", "", "1", "2", "kin", "i+1", "theta_1"]),
    st.sampled_from([0, 0, 1, 2]),
    st.sampled_from([0, 0, 0, 1]),
    st.booleans(),
)
atoms = st.one_of(numbers, letters)


def composite(nodes: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
    """Trees around other trees."""
    factors = nodes.filter(lambda node: not isinstance(node, Product))
    signs = st.sampled_from([1, -1])
    terms = nodes.filter(lambda node: not isinstance(node, Sum) or len(node.terms) > 1)
    rows = st.integers(1, 2).flatmap(
        lambda n: st.lists(st.tuples(*[nodes] * n), min_size=1, max_size=2).map(tuple)
    )
    return st.one_of(
        st.lists(st.tuples(signs, terms), min_size=2, max_size=3).map(lambda t: Sum(tuple(t), AT)),
        terms.map(lambda term: Sum(((-1, term),), AT)),
        st.lists(factors, min_size=2, max_size=4).map(lambda f: Product(tuple(f), AT)),
        st.builds(Quotient, nodes, nodes, st.just(AT)),
        st.builds(Power, nodes, nodes, st.just(AT)),
        st.builds(Root, nodes, st.sampled_from([2, 3]), st.just(AT)),
        st.builds(Call, st.sampled_from(["sin", "cos", "asin", "log"]), nodes, st.just(AT)),
        st.builds(Application, letters, st.tuples(nodes, nodes), st.just(AT)),
        st.builds(Derivative, nodes, st.tuples(letters), st.booleans(), st.just(AT)),
        st.builds(Matrix, rows, st.just(AT)),
        st.builds(Tuple, st.tuples(nodes, nodes), st.just(AT)),
    )


trees = st.recursive(atoms, composite, max_leaves=12)


class Writer:
    """Writes trees; each spelling is chosen at random."""

    def __init__(self, random: Random) -> None:
        self.random = random

    def one_of(self, *spellings: str) -> str:
        return self.random.choice(spellings)

    def brackets(self, text: str) -> str:
        return self.one_of(
            rf"\left({text}\right)", f"({text})", rf"\bigl[ {text} \bigr]", f"[{text}]"
        )

    def round(self, text: str) -> str:
        return self.one_of(rf"\left( {text} \right)", f"({text})", rf"\Big({text}\Big)")

    def script(self, text: str) -> str:
        is_single = len(text) == 1 and not text.isdigit()
        return text if is_single and self.random.random() < 0.5 else f"{{{text}}}"

    def letter(self, letter: Letter) -> str:
        name = f"\\{letter.name} " if letter.name in GREEK else letter.name
        if letter.name == "phi" and not letter.is_bold:
            name = self.one_of(name, "φ ")
        if letter.is_bold:
            name = self.one_of(rf"\mathbf{{{name}}}", rf"\vec {name}", rf"\boldsymbol{{{name}}}")
        index = {"": "", "kin": r"_{\text{kin}}", "theta_1": r"_{\theta_1}"}.get(
            letter.index, f"_{self.script(letter.index)}"
        )
        if letter.dots:
            accent = "\\" + "d" * (letter.dots - 1) + "dot"
            if index and self.random.random() < 0.5:
                return rf"{accent}{{{name}{index}}}" + "'" * letter.primes
            name = self.one_of(rf"{accent}{{{name}}}", rf"{accent} {{{name} }}")
        prime = self.one_of("'", r"^{\prime}") if letter.primes else ""
        return self.one_of(name + index + prime, name + prime + index)

    def write(self, node: Node) -> str:
        """LaTeX of a tree."""
        match node:
            case Number():
                return f" {node.digits} "
            case Letter():
                return self.letter(node)
            case Sum():
                parts = [("+" if s > 0 else "-") + self.term(term) for s, term in node.terms]
                return "".join(parts).removeprefix("+" if self.random.random() < 0.7 else " ")
            case Product():
                return self.product(node)
            case Quotient():
                top, bottom = self.write(node.numerator), self.write(node.denominator)
                if isinstance(node.numerator, Letter) and isinstance(node.denominator, Letter):
                    return f"{{{top} / {bottom}}}"
                return self.one_of(rf"\frac{{{top}}}{{{bottom}}}", rf"{{{top} \over {bottom}}}")
            case Power():
                return f"{self.atom(node.base)}^{{{self.write(node.exponent)}}}"
            case Root():
                degree = "" if node.degree == 2 else f"[{node.degree}]"
                return rf"\sqrt{degree}{{{self.write(node.radicand)}}}"
            case Call():
                return self.call(node)
            case Application():
                return self.letter(node.head) + self.round(
                    ", ".join(map(self.write, node.arguments))
                )
            case Derivative():
                return self.derivative(node)
            case Matrix():
                name = self.one_of("pmatrix", "bmatrix", "matrix")
                rows = r" \\ ".join(" & ".join(map(self.write, row)) for row in node.rows)
                return rf"\begin{{{name}}}{rows}\end{{{name}}}"
            case Tuple():
                return self.brackets(", ".join(map(self.write, node.items)))
        raise TypeError(node)

    def term(self, node: Node) -> str:
        text = self.write(node)
        return self.brackets(text) if isinstance(node, Sum) else text

    def atom(self, node: Node) -> str:
        """LaTeX to which an exponent can be added."""
        text = self.write(node)
        is_closed = isinstance(node, Number | Root | Matrix) or (
            isinstance(node, Letter) and not node.primes
        )
        return text if is_closed else self.round(text)

    def call(self, node: Call) -> str:
        if node.function == "asin":
            name = self.one_of(r"\arcsin", r"\sin^{-1}", r"\operatorname{arcsin}")
        else:
            name = "\\" + {"log": "ln"}.get(node.function, node.function)
        argument = node.argument
        if isinstance(argument, Letter) and self.random.random() < 0.5:
            return f"{name} {self.letter(argument)} "
        return name + self.brackets(self.write(argument))

    def derivative(self, node: Derivative) -> str:
        sign = r"\partial " if node.is_partial else self.one_of("d ", r"\mathrm{d}")
        below = sign + self.write(node.variables[0])
        operand = self.write(node.operand)
        if isinstance(node.operand, Letter) and self.random.random() < 0.5:
            return rf"\frac{{{sign}{operand}}}{{{below}}}"
        return rf"\frac{{{sign}}}{{{below}}}" + self.round(operand)

    def product(self, node: Product) -> str:
        text = ""
        for factor in node.factors:
            written = self.write(factor)
            if isinstance(factor, Sum | Power):
                written = self.round(written)
            sign = self.one_of(r"\cdot ", "*") if text else ""
            may_touch = isinstance(factor, Letter | Root | Matrix)
            if text and may_touch and not text.endswith("@") and self.random.random() < 0.5:
                sign = self.one_of(r"\,", " ", r"\;")
            text += sign + written + ("@" if isinstance(factor, Call) else "")
        return text.replace("@", "")


@st.composite
def written_trees(draw: st.DrawFn) -> tuple[Node, str]:
    """A tree and its LaTeX."""
    tree = draw(trees)
    random = draw(st.randoms(use_true_random=False))
    return tree, Writer(random).write(tree)
