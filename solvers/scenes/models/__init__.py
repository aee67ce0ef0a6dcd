"""Models of a motion, one class in one file each, and the selection of the smallest."""
