"""The ``rodsim`` command: finds the commands, turns errors into text and exit codes.

Results go to stdout, everything else to stderr. Nothing heavy is imported up here.
"""

from __future__ import annotations

import errno
import os
import sys
from importlib import import_module

import click

import rodsim
from rodsim.errors import RodsimError
from rodsim.text import printable

COMMANDS = (  # as the help lists them
    "new",
    "validate",
    "info",
    "run",
    "resume",
    "rest",
    "stability",
    "sweep",
    "converge",
    "energy",
    "measure",
    "plot",
    "view",
    "flow",
    "export",
    "schema",
    "cite",
)
WHOLE = 1000  # characters: more than a first sentence has
DISK = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)  # full, or gone
EXIT_CODES = """\b
Exit codes:
   0  done
   1  a bug in rodsim
   2  bad usage, or a case file missing, unreadable or invalid
   3  the run diverged
   4  an output or shape file missing, unreadable, locked or not ours,
      or a write failed
  75  stopped early on purpose: go on with rodsim resume
"""


class _Group(click.Group):
    """Loads ``rodsim.commands.<name>`` when it is asked for; errors become exit codes only here."""

    def list_commands(self, ctx):
        return list(COMMANDS)

    def get_command(self, ctx, name):
        if name not in COMMANDS:
            return None
        return getattr(import_module(f"rodsim.commands.{name}"), name)

    def format_commands(self, ctx, formatter):
        """List the commands with their first sentences, which click would cut at the line's end."""
        rows = [(c, self.get_command(ctx, c).get_short_help_str(WHOLE)) for c in COMMANDS]
        with formatter.section("Commands"):
            formatter.write_dl(rows)

    def invoke(self, ctx):
        try:
            return super().invoke(ctx)
        except RodsimError as error:
            click.echo(printable(str(error)), err=True)
            ctx.exit(error.exit_code)
        except KeyboardInterrupt:
            click.echo("interrupted", err=True)
            ctx.exit(75)
        except BrokenPipeError:
            sys.stderr.close()  # whoever read our output has gone; nothing is left to say
            ctx.exit(0)
        except OSError as error:
            if error.errno not in DISK:
                raise
            click.echo(f"the result could not be written: {error.strerror}", err=True)
            os._exit(4)  # what is left of it would fail again at the end of the process


@click.group(
    cls=_Group, epilog=EXIT_CODES, context_settings={"help_option_names": ["-h", "--help"]}
)
@click.version_option(rodsim.__version__, package_name="rodsim")
def main():
    """Elastic rods that bend, twist, shear and stretch in a fluid at zero Reynolds number.

    Start with: rodsim new ring case.yaml, then rodsim run case.yaml
    """
