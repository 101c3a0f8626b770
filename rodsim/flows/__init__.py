"""What moves rods: each flow is one file."""
