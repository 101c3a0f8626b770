"""The generalized immersed boundary (gIB) method: the rival that section 6 compares with.

Lim, Ferent, Wang & Peskin, SIAM J. Sci. Comput. 31 (2008) 273-302; Lim, Phys. Fluids 22 (2010)
024104; section 5 of Olson, Lim & Cortez (2013). The rod is rodsim's own, the fluid obeys the
Navier-Stokes equations on a periodic grid. One case file, one output file, two methods.
"""
