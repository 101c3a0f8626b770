"""``python -m rodsim`` and the ``rodsim`` command."""

import os
import sys

from rodsim import cli


def main():
    """Run the command; leave without clean-up if a file could not be written.

    HDF5 cannot be closed after a failed write: it tries again to write what did not fit, and can
    end the process in a crash that hides our message and exit code.
    """
    try:
        cli.main(prog_name="rodsim")
    except SystemExit as end:
        writer = sys.modules.get("rodsim.output.writer")
        if writer and writer.abandoned:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(end.code)
        raise


if __name__ == "__main__":
    main()
