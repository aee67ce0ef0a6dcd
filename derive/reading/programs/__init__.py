"""Programs that simulate a motion: their equations, and their method of integration.

`reader.read_program` is the front door and returns a `program.Program`. Text becomes statements,
statements become values of variables, and these become equations and findings:

=====================================  ========================================================
`languages/`                           the roles of the nodes of each grammar of tree-sitter
`expressions`, `definitions`,          from nodes to the trees of `trees` and the statements of
`statements`                           `code`, which are the same for all languages
`values`, `calls`, `following`         the values of variables, statement by statement
`arrays`, `array_functions`,           operations and functions that these values contain
`mathematics`, `elementwise`, `sums`
`context`, `regions`                   functions, loops, constants, and names assigned once
`rates`, `updates`, `runge_kutta`      functions of rates; variables changed step by step
`equations`, `naming`, `writing`       equations in the syntax of formulas
`methods`, `libraries`, `degrees`      findings
`judged`                               all of them, each once
=====================================  ========================================================
"""
