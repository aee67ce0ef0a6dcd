"""Export of equations and of whole simulations to other languages."""
