"""Results: recorded states, crossings within steps, solutions of one motion and of many."""
