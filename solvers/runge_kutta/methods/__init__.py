"""Methods, one a file: each defines ``tableau`` and is found by its file's name."""
