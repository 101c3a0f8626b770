"""The methods in time, a file each; what is known of them is in :mod:`rodsim.case.methods`."""
