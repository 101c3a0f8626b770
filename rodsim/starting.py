"""What the start of a process of the command leaves out. The library never comes here."""

import gc
import os
import sys
from importlib import import_module
from types import ModuleType

# Importing makes many objects and no garbage: looking for it after every 700, as Python does by
# default, takes a tenth of the time to start, and looking once a twentieth.
OBJECTS_BETWEEN_COLLECTIONS = 300_000
PLUGINS, NONE = "PYDANTIC_DISABLE_PLUGINS", "__all__"


def start_quickly() -> None:
    """Look for garbage seldom, and for plugins of pydantic not at all, unless the user does."""
    gc.set_threshold(OBJECTS_BETWEEN_COLLECTIONS)
    if os.environ.setdefault(PLUGINS, NONE) == NONE:
        name = "pydantic.plugin._loader"
        sys.modules.setdefault(name, _NoPlugins(name))


class _NoPlugins(ModuleType):
    """Says that there are no plugins, without importing what would look for them in all packages.

    Where pydantic asks for more, it gets its own module.
    """

    @staticmethod
    def get_plugins():
        """Return none."""
        return ()

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        sys.modules.pop(self.__name__, None)
        return getattr(import_module(self.__name__), name)
