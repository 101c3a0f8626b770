"""The period of a run, given as an expression of its parameters."""

from __future__ import annotations

import numpy as np

from rodsim.case import Expression, ExpressionError
from rodsim.errors import UsageError


def period_of(text: str, parameters: dict, who: str = "") -> float:
    """Return the period that an expression such as ``2*pi/sigma`` comes to; raises UsageError.

    ``who`` : named in the message.
    """
    try:
        value = float(Expression(text, parameters)(np.zeros(()), 0.0))
    except ExpressionError as error:
        raise UsageError(f"--period {text}: {error}") from error
    if not 0.0 < value < np.inf:
        raise UsageError(f"--period {text}: is {value:g}{who}: must be > 0")
    return value
