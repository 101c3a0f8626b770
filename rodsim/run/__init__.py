"""A run: start, resume, march, record, watch, stop."""
