"""A case or a stored file made ready to run: nodes, state, parts, the one loop, the system."""
