"""The technical report "Comparing Method in Double Pendulum", equation by equation.

Every numbered equation and every display of Appendix A is kept as its LaTeX and
judged against the derivation from positions. The verdicts are computed.
"""
