"""Variations of motions: tangents, sensitivities, transition matrices, Lyapunov exponents."""
