"""Links that pictures show between points."""
