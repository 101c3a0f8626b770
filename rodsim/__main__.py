"""``python -m rodsim`` and the ``rodsim`` command."""

from rodsim.cli import main

if __name__ == "__main__":
    main()
