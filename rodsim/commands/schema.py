"""``rodsim schema``."""

import click


@click.command()
def schema():
    """Print the JSON Schema of the case file, for editors."""
    import json

    from rodsim.case import case_schema

    click.echo(json.dumps(case_schema(), indent=2))
