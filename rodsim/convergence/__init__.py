"""Error against run time of one scene: rows of runs, each held against a reference of its own.

``study`` makes the runs, ``report`` the table, the CSV and the picture.
"""
