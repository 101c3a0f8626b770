"""Many runs of one case: each is one command in one folder, so nothing depends on who starts it.

``plan`` makes the runs, ``work`` does one of them where it is called, ``engine`` calls it through
Dask, ``summary`` reads the outputs. What a run has come to is always read from its output file.
"""
