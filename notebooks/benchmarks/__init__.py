"""How fast compiled loops are beside other programs and beside what the machine can do."""
