"""Application: the command line, the demonstration, and the verdict on the report."""
