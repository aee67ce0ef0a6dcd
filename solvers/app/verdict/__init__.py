"""The verdict on the report: its objectives, its claims and its recommendations."""
