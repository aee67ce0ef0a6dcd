"""Problems: options and their checks, inputs, events, switching functions."""
