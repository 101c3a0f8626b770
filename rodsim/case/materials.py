"""A round rod of one material: its moduli from Young's modulus, its blob from its radius.

Radius of a filament and width of the blob. A long straight line of regularized Stokeslets moves
sideways, under a force f per length over 2L, with f (2 ln(2L/epsilon) + c) / (8 pi mu), where c = 2
for algebraic7 and c = 3 for algebraic9; a cylinder of radius a with f (2 ln(2L/a) + 1) / (8 pi mu)
(Batchelor 1970). They are the same, also lengthways, for a = epsilon exp(-1/2) = 0.607 epsilon and
a = epsilon exp(-1) = 0.368 epsilon.
"""

from __future__ import annotations

import math
from typing import Annotated, Any

from pydantic import Field, model_validator

from rodsim.case.fields import Model, Positive, quantity

WIDTHS = {"algebraic7": math.exp(0.5), "algebraic9": math.exp(1.0)}  # epsilon over radius
INCOMPRESSIBLE = 0.5
_KEYS = ("young", "radius", "poisson")


class Radius(Model):
    """The radius of a filament, from which the width of its blob follows."""

    radius: Positive = quantity(
        "length", "epsilon is 1.649 (algebraic7) or 2.718 (algebraic9) times it"
    )


class Material(Model):
    """Young's modulus and radius in place of moduli; a modulus given beside them counts."""

    young: Positive | None = quantity(
        "pressure",
        "Young's modulus E of a round rod: a = E pi r^4/4, a3 = G pi r^4/2, b = k G pi r^2, b3 = "
        "E pi r^2, with G = E/(2 (1 + nu)), k = 6 (1 + nu)/(7 + 6 nu)",
        default=None,
    )
    radius: Positive | None = quantity("length", "its radius r", default=None)
    poisson: Annotated[float, Field(strict=True, gt=-1.0, le=0.5, allow_inf_nan=False)] | None = (
        Field(None, description="its Poisson's ratio nu; default 0.5, incompressible")
    )

    @model_validator(mode="before")
    @classmethod
    def _from_young(cls, data: Any) -> Any:
        """Put moduli in the place of what they follow from."""
        if not isinstance(data, dict) or not any(key in data for key in _KEYS):
            return data
        given = [data.get("young"), data.get("radius"), data.get("poisson", INCOMPRESSIBLE)]
        good = all(type(value) in (int, float) for value in given)
        if not (good and given[0] > 0 and given[1] > 0 and -1 < given[2] <= 0.5):
            return {**dict.fromkeys(_MODULI, 1.0), **data}  # refused below, for one reason
        if all(key in data for key in _MODULI):
            return data
        rest = {key: value for key, value in data.items() if key not in _KEYS}
        return {**round_rod(*given), **rest}

    @model_validator(mode="after")
    def _whole(self):
        if self.young is not None and self.radius is not None:
            raise ValueError(f"young has no effect: {', '.join(_MODULI)} are all given")
        if any(getattr(self, key) is not None for key in _KEYS):
            raise ValueError("young and radius belong together: give both")
        return self


_MODULI = ("bending", "twisting", "shear", "stretch")


def round_rod(young: float, radius: float, poisson: float) -> dict[str, float]:
    """Return the moduli of a round rod.

    a = E I, a3 = G J, b = k G A, b3 = E A with I = pi r^4/4, J = 2 I, A = pi r^2,
    G = E/(2 (1 + nu)) and the shear coefficient k = 6 (1 + nu)/(7 + 6 nu) of Cowper (1966).
    """
    area, second = math.pi * radius**2, math.pi * radius**4 / 4.0
    shear = young / (2.0 * (1.0 + poisson))
    coefficient = 6.0 * (1.0 + poisson) / (7.0 + 6.0 * poisson)
    return {
        "bending": young * second,
        "twisting": shear * 2.0 * second,
        "shear": coefficient * shear * area,
        "stretch": young * area,
    }
