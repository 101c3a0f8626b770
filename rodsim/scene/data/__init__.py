"""What people bring: text tables and other programs' files, read into points and triads."""
