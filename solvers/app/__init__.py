"""The command line, the demonstration, the verdicts on the report, and scenes by name."""
