"""What the start of a process of the command leaves out. The library never comes here."""

import gc
import os

# Importing makes many objects and no garbage: looking for it after every 700, as Python does by
# default, takes a tenth of the time to start, and looking once a twentieth.
OBJECTS_BETWEEN_COLLECTIONS = 300_000


def start_quickly() -> None:
    """Look for garbage seldom, and for plugins of pydantic not at all, unless the user does."""
    gc.set_threshold(OBJECTS_BETWEEN_COLLECTIONS)
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
