"""C99: one file without dependencies but the mathematical library."""

from collections.abc import Iterable, Iterator

from derive.codegen.export.target import Target

ROW = """\
/* Print a row of output, with all digits. */
static void print_row(double t, const double *values)
{{
    printf("%.17g", t);
    for (int n = 0; n < COLUMNS; n++) {{
        printf(",%.17g", values[n]);
    }}
    printf("\\n");
}}
"""

#: Of a header, whose functions may be those of a GPU.
GUARD = """\
#pragma once
#ifndef HOLONOMIC_FUNCTION
#define HOLONOMIC_FUNCTION static inline
#endif
"""

MAIN = """\
int main(void)
{{
    printf("{heading}\\n");
    return simulate() ? 0 : 3;
}}
"""


class C99(Target):
    """Functions with vectors as pointers."""

    title, suffix, library_suffix = "C99", ".c", ".h"
    row, main = ROW, MAIN
    command = "cc -std=c99 -O2 -ffp-contract=off {file} -o {stem} -lm && ./{stem}"
    arithmetic = "Compile with -ffp-contract=off, or products and sums are fused on some machines."
    comment = "/* {} */"
    unused = "(void){name};"
    reserved = "size_t main printf remainder signbit"
    #: Qualifiers of the functions of a header, which CUDA defines as __device__ static inline.
    qualifiers = "HOLONOMIC_FUNCTION"
    integer = "enum {{ {name} = {value} }};"

    def remarks(self, lines: Iterable[str]) -> Iterator[str]:
        text = "\n   ".join(lines)
        yield f"/* {text} */".replace("\n   \n", "\n\n")

    def head(self) -> str:
        return f"{self.guard()}#include <math.h>\n#include <stdbool.h>\n" + (
            "#include <stdio.h>\n" if self.exported.columns else ""
        )

    def guard(self) -> str:
        """The line that lets a header be included once."""
        return "" if self.exported.columns else GUARD

    def signature(self) -> str:
        parts = []
        for name, kind in self.routine.parameters.items():
            constant = "" if name in self.routine.changed else "const "
            vector = f"{constant}double *{self.name(name)}"
            parts.append(vector if kind == "vector" else f"{self.types[kind]} {self.name(name)}")
        returns = self.types.get(self.routine.returns or "", "void")
        qualifiers = "static" if self.exported.columns else self.qualifiers
        return f"{qualifiers} {returns} {self.routine.name}({', '.join(parts) or 'void'}) {{"


target = C99
