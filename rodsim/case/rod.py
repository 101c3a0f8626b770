"""One rod of a case; kinds of parts add their words to it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from rodsim.case.expressions import Expression
from rodsim.case.fields import (
    Count,
    Model,
    Modulus,
    ModulusOrPair,
    Name,
    Number,
    ParameterName,
    quantity,
    text_tag,
)
from rodsim.case.materials import Material
from rodsim.case.shapes import Perturb, Shape
from rodsim.case.strain import OWN, TABLES, OneOfThree, StrainEntry, StrainTable, StrainTables
from rodsim.registry import with_words


class Moduli(Material):
    """Elastic moduli: numbers, or expressions in s at the middle of a segment.

    Bending and shear may differ along D1 and D2.
    """

    bending: ModulusOrPair = quantity("bending", "a1 = a2, or [a1, a2]")
    twisting: Modulus = quantity("bending", "a3")
    shear: ModulusOrPair = quantity("force", "b1 = b2, or [b1, b2]")
    stretch: Modulus = quantity("force", "b3")

    @property
    def values(self) -> tuple[float | Expression, ...]:
        """The moduli as (a1, a2, a3, b1, b2, b3)."""
        return (*_pair(self.bending), self.twisting, *_pair(self.shear), self.stretch)

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of the values."""
        return ("bending", "bending", "twisting", "shear", "shear", "stretch")

    @property
    def vary(self) -> bool:
        """Whether any of them is an expression."""
        return any(isinstance(value, Expression) for value in self.values)


def _pair(value):
    return value if isinstance(value, tuple) else (value, value)


@with_words
class Rod(Model):
    """One elastic rod."""

    like: Name | None = Field(
        None,
        description="another rod that says what is left out here: mappings are merged, lists and "
        "values replaced, null takes a key out",
    )
    repeat: Count | None = Field(
        None, description="make NAME_0, NAME_1, ...: so many, with the number as i in expressions"
    )
    parameters: dict[ParameterName, Number] = Field(
        {}, description="names for its expressions; they replace those of the case or add to them"
    )
    shape: Shape = Field(description="how it starts")
    moduli: Moduli = Field(description="elastic moduli")
    strain_twist: Annotated[
        Annotated[Literal["natural"], Tag("<text>")]
        | Annotated[StrainTables, Tag("<mapping>")]
        | Annotated[tuple[StrainEntry, StrainEntry, StrainEntry], Tag("<list>")],
        Discriminator(text_tag),
    ] = quantity(
        "curvature",
        "natural: of the shape as built; or Omega_1, Omega_2, Omega_3: numbers, expressions in s, "
        "t, natural_1..3 and the parameters, or tables; or one table of all three",
        default=(0.0, 0.0, 0.0),
    )
    perturb: Perturb | None = Field(
        None, description="disturbs the start, which symmetry may else keep from what is unstable"
    )

    @property
    def entries(self) -> tuple[float | Expression | StrainTable | OneOfThree, ...]:
        """Omega_1, Omega_2, Omega_3."""
        given = self.strain_twist
        if isinstance(given, StrainTables):
            return given.entries
        return OWN if given == "natural" else given

    @property
    def driven(self) -> bool:
        """Whether its strain twist depends on time, or may: a table is not read yet."""
        return any(
            isinstance(entry, TABLES) or (isinstance(entry, Expression) and entry.uses_t)
            for entry in self.entries
        )

    @property
    def uses_natural(self) -> bool:
        """Whether its strain twist depends on that of its shape."""
        return any(isinstance(entry, Expression) and entry.uses_natural for entry in self.entries)

    @property
    def files(self) -> list[str]:
        """The files of its shape and its tables, as the case names them."""
        shape = getattr(self.shape, "path", None)
        tables = dict.fromkeys(e.table for e in self.entries if isinstance(e, TABLES))
        return [path for path in (shape, *tables) if path is not None]

    @property
    def needs_data(self) -> bool:
        """Whether its strain twist is known only once the rod is built or a table read."""
        return self.uses_natural or any(isinstance(entry, TABLES) for entry in self.entries)
