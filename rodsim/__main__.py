"""``python -m rodsim`` and the ``rodsim`` command."""

import gc
import os
import sys

from rodsim.starting import start_quickly
from rodsim.streams import prepare_streams


def main():
    """Run the command; leave without clean-up if a file could not be written.

    HDF5 cannot be closed after a failed write: it tries again to write what did not fit, and can
    end the process in a crash that hides our message and exit code.
    """
    start_quickly()
    prepare_streams()
    from rodsim import cli  # once nothing is looked for any more

    try:
        cli.main(prog_name="rodsim")
    except SystemExit as end:
        writer = sys.modules.get("rodsim.output.writer")
        if writer and writer.abandoned:
            if sys.stdout:
                sys.stdout.flush()
            sys.stderr.flush()
            os._exit(end.code)
        raise
    finally:
        gc.freeze()  # Python looks for garbage once more at its end, in all that was imported


if __name__ == "__main__":
    main()
