"""Compiled integration loops: the C program, its compiler, and its interface to Python."""
