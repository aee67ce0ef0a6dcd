"""Formulas of documents and programs, as syntax trees; nothing that is read is executed."""
