"""What must be the same, bit for bit, in the files of an interrupted and an unbroken run."""

import h5py

GROUPS = ("particles", "observables", "rods", "VTKHDF")
COSTS = ("evaluations", "steps_accepted", "steps_rejected", "max_stages", "spectral_radius")


def contents(path):
    """Return every dataset of the results as bytes, the counters, and how many frames count."""
    found = {}

    def visit(name, node):
        if isinstance(node, h5py.Dataset) and name.startswith(GROUPS):
            found[name] = node[()].tobytes()

    with h5py.File(path, "r", locking=False) as file:
        file.visititems(visit)
        found |= {name: file["runtime"].attrs[name].tobytes() for name in COSTS}
        found["steps of the view"] = int(file["VTKHDF/Steps"].attrs["NSteps"])
        found["committed"] = int(file["committed"][()])
        found["times"] = file["case/times"][()].tobytes()
        found["status"] = bytes(file.attrs["status"])
    return found


def differences(path, other):
    """Return the names of what differs between two files."""
    ours, theirs = contents(path), contents(other)
    return [name for name in ours.keys() | theirs.keys() if ours.get(name) != theirs.get(name)]
