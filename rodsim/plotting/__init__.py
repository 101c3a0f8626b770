"""Pictures. Matplotlib is imported here and nowhere else, and only when one is drawn."""
