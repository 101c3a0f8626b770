"""The fast sum: arcs of rods as clusters, some of an arc's own points as its proxies."""
