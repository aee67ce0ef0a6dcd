"""C++17: one file without dependencies."""

from derive.codegen.export.targets.c99 import C99


class Cpp(C99):
    """The functions of C99, in a namespace."""

    title, suffix, library_suffix = "C++", ".cpp", ".hpp"
    row = C99.row.replace("static ", "inline ").replace("printf", "std::printf")
    main = (
        C99.main.replace("(void)", "()")
        .replace("printf", "std::printf")
        .replace("simulate", "{name}::simulate")
    )
    command = "c++ -std=c++17 -O2 -ffp-contract=off {file} -o {stem} && ./{stem}"
    functions = {"abs": "std::fabs"} | {
        name: f"std::{name}"
        for name in "sqrt floor sin cos tan exp log sinh cosh tanh atan atan2 pow".split()
    }
    unused = "(void){name};"
    reserved = (
        f"{C99.reserved} bool catch class concept constexpr delete explicit export friend mutable "
        "namespace operator protected requires template throw typename using virtual xor std"
    )
    qualifiers = "inline"
    integer, real = "constexpr int {name} = {value};", "constexpr double {name} = {value};"
    table = "constexpr double {name}[{size}] = {{", "}};"

    def head(self) -> str:
        output = "#include <cstdio>\n" if self.exported.columns else ""
        return f"{self.guard()}#include <cmath>\n{output}\nnamespace {self.exported.name} {{"

    def signature(self) -> str:
        text = super().signature().replace("(void)", "()")
        return text.replace("static ", f"{self.qualifiers} ", 1)

    def tail(self) -> str:
        return f"}}  // namespace {self.exported.name}\n\n{super().tail()}"


target = Cpp
