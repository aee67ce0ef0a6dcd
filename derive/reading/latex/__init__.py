"""The LaTeX of mechanics as syntax trees."""
