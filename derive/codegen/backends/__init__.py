"""Target languages, one file each; a file defines `backend` and is found by its place here."""
