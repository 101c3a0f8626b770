"""What compiled code stands on: flags, settings, rotations, threads."""
