"""The computation of a sweep: chunks, workers, folders."""
