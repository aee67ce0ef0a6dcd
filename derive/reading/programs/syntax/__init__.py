"""Expressions and statements of programs, whatever their language."""
