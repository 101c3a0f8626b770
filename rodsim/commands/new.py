"""``rodsim new``."""

from pathlib import Path

import click


@click.command()
@click.argument("kind", type=click.Choice(["open", "ring", "flagellum"]))
@click.argument("file", required=False, type=click.Path(path_type=Path, dir_okay=False))
def new(kind, file):
    """Write a commented case to start from, to FILE or to the terminal."""
    from rodsim.case import template
    from rodsim.errors import FileError

    if file is None:
        click.echo(template(kind), nl=False)
        return
    try:
        with file.open("x", encoding="utf-8") as stream:
            stream.write(template(kind))
    except FileExistsError:
        raise FileError(f"{file}: exists already, not overwritten") from None
    except OSError as error:
        raise FileError(f"{file}: cannot be written: {error.strerror}") from error
    click.echo(f"wrote {file}; run it with: rodsim run {file}", err=True)
