"""``rodsim new``."""

from pathlib import Path

import click

from rodsim.text import printable


def _complete(ctx, param, incomplete):
    from rodsim.case.templates import scenes

    return [name for name in scenes() if name.startswith(incomplete)]


@click.command()
@click.argument("name", required=False, shell_complete=_complete)
@click.argument("file", required=False, type=click.Path(path_type=Path, dir_okay=False))
def new(name, file):
    """Write a case to start from, to FILE or to the terminal; without a NAME: list them.

    ring, open and flagellum have a comment for each key; the others are the scenes that come with
    rodsim. Tables that a case reads are written beside FILE.
    """
    from rodsim.case.templates import scenes, tables_of, template

    if name is None:
        _list(scenes())
    elif file is None:
        click.echo(template(name), nl=False)
        for table in tables_of(name):
            click.echo(f"note: reads {table.name}; rodsim new {name} FILE writes it too", err=True)
    else:
        text = template(name)
        for table in tables_of(name):  # first: with another's table the case would be another
            _write_table(file.with_name(table.name), table.read_text(encoding="utf-8"))
        _write(file, text)
        if file.suffix != ".csv":
            click.echo(printable(f"run it with: rodsim run {file}"), err=True)


def _list(names):
    from rodsim.case.templates import title

    width = max(map(len, names))
    for name in names:
        click.echo(f"{name:{width}}  {title(name)}")


def _write_table(file, text):
    """Write a table, unless it is there already, word by word."""
    if not (file.is_file() and file.read_bytes() == text.encode()):
        _write(file, text)


def _write(file, text):
    from rodsim.errors import FileError

    try:
        with file.open("x", encoding="utf-8") as stream:
            stream.write(text)
    except FileExistsError:
        raise FileError(f"{file}: exists already, not overwritten") from None
    except OSError as error:
        raise FileError(f"{file}: cannot be written: {error.strerror}") from error
    click.echo(printable(f"wrote {file}"), err=True)
