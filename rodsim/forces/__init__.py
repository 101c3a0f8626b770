"""What acts on rods: each force is one file."""
