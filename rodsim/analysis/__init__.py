"""Pure functions on the arrays of a run."""
