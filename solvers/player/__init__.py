"""A page that plays motions in real time: one HTML file without external resources."""
