"""Commands called in this process, as users type them."""

from click.testing import CliRunner

from rodsim.cli import main


def call(*arguments, **options):
    """Return what a command said, and how it ended; options of the runner: terminal_width."""
    return CliRunner().invoke(main, [str(argument) for argument in arguments], **options)


def command(*arguments, code=0):
    """Return what a command said; it must end with an exit code."""
    result = call(*arguments)
    assert result.exit_code == code, (result.output, result.exception)
    return result


def told(*arguments, code=0):
    """Return what a command said beside results, of which it must have none."""
    result = command(*arguments, code=code)
    assert result.stdout == ""
    return result.stderr


def settings(*changes):
    """Return the words that change a case so."""
    return [word for change in changes for word in ("--set", change)]
