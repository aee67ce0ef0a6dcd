"""The demonstration: all stages from positions to motions, on one page."""
