"""Systems, one a file: each defines ``system`` and is found by its file's name."""
