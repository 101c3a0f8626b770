"""One command, one file: parse, call, print. Heavy imports are inside the functions."""
