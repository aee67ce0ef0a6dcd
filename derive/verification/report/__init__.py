"""The technical report "Comparing Method in Double Pendulum", equation by equation.

Every numbered equation, and every display of its Appendix A, is typed as it is
printed and judged against the derivation from positions. The verdicts are
computed; what is asserted here is only what stands on the paper.
"""
