"""One file a format: its suffixes, its delimiters of formulas, and its parts that hold none."""
