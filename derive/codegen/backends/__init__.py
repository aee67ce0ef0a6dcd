"""Target languages, one file each, found by their files; each file defines `backend`."""
