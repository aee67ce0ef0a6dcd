"""One file a format: its delimiters of formulas, and its parts that hold none."""
