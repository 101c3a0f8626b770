"""Rigid blocks: cell bodies, the held ends of rods, and the joints between them."""
