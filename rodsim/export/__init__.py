"""Files for other programs: .csv, .npz, and .vtkhdf, which ParaView opens."""
