"""States at rest, and whether they are stable: where all loads are zero, nothing moves."""
