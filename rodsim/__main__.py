"""``python -m rodsim`` and the ``rodsim`` command."""

import gc
import os
import sys

from rodsim import cli
from rodsim.streams import prepare_streams

# Importing makes many objects and no garbage: looking for it after every 700, as Python does by
# default, takes a tenth of the time to start.
OBJECTS_BETWEEN_COLLECTIONS = 100_000


def main():
    """Run the command; leave without clean-up if a file could not be written.

    HDF5 cannot be closed after a failed write: it tries again to write what did not fit, and can
    end the process in a crash that hides our message and exit code.
    """
    gc.set_threshold(OBJECTS_BETWEEN_COLLECTIONS)
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # looked for in every package
    prepare_streams()
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
