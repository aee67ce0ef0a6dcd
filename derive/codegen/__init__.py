"""Code generation: from derived equations to Python and C."""
