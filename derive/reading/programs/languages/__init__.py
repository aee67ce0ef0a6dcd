"""The languages of programs, one file each."""
