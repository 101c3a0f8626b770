"""The figures and tables of Olson, Lim & Cortez (2013), one module for each scene."""
