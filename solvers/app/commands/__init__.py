"""One command a file: ``SUMMARY``, ``add_arguments(parser)`` and ``run(arguments)``.

Nothing that computes is imported before a command runs, so that help and completion are quick.
"""
