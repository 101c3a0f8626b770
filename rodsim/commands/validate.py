"""``rodsim validate``."""

from pathlib import Path

import click

from rodsim.commands.common import load, say_warnings, set_option
from rodsim.errors import RodsimError


@click.command()
@click.argument(
    "cases", metavar="CASE.yaml...", nargs=-1, required=True, type=click.Path(path_type=Path)
)
@set_option
@click.pass_context
def validate(ctx, cases, overrides):
    """Check case files and report every problem at once; run nothing."""
    code = 0
    for path in cases:
        try:
            case = load(path, overrides)
            from rodsim.scene.build import build_scene

            scene = build_scene(case)
        except RodsimError as error:
            click.echo(str(error), err=True)
            code = max(code, error.exit_code)
        else:
            say_warnings(case, scene)
            click.echo(f"{path}: valid")
    ctx.exit(code)
