"""Points of a system: equilibria, and motions near a point."""
