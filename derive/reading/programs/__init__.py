"""Programs that simulate a motion: their equations, and their method of integration.

`program_reader.read_program` is the front door and returns a `program.Program`. Text
becomes statements, statements become values of variables, and these become equations and findings:

=====================================  ========================================================
`languages/`                           the roles of the nodes of each grammar of tree-sitter
`expressions`, `definitions`,          from nodes to the trees of `trees` and the statements of
`statement_translation`                `code`, which are the same for all languages
`values`, `calls`, `following`         the values of variables, statement by statement
`arrays`, `mathematics`, `sums`        operations and functions that these values contain
`context`, `regions`, `counted_loops`  functions, loops, constants, and names assigned once
`rates`, `updates`,                    functions of rates; variables changed step by step
`runge_kutta`, `stages`
`function_equations`, `formula_text`   equations in the syntax of formulas
`step_methods`, `degrees`              findings
`program_findings`                     all of them, each once
=====================================  ========================================================
"""
