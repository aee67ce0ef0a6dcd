"""Programs that simulate a motion: their equations, and their method of integration."""
