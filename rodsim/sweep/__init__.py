"""Many runs of one case: each is one command in one folder, so nothing depends on who starts it.

``plan`` makes the runs, ``work`` does one of them where it is called, by one of the ``workers``
there. ``schedule`` has them done through an engine: ``local``, this machine, or ``cluster``, the
workers of a Dask scheduler. ``summary`` reads the outputs. What a run has come to is always read
from its output file.
"""
