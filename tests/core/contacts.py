"""Random contacts, and what every contact law is asked about them."""

from dataclasses import dataclass, replace

import numpy as np
from deformable import core
from hypothesis import strategies as st

LAWS = {"sector": core.sector, "area_sector": core.area_sector, "ring": core.ring}


@dataclass(frozen=True)
class Contacts:
    """What presses on one particle."""

    radius: float
    angle: np.ndarray
    indentation: np.ndarray

    def shape(self, law):
        return LAWS[law](self.radius, self.angle, self.indentation)

    def outline(self, law, points=180):
        return core.outline(law, self.radius, self.angle, self.indentation, points)

    def moved(self, name, contact, step):
        """The same contacts, `name` of one of them changed by `step`."""
        values = getattr(self, name).copy()
        values[contact] += step
        return replace(self, **{name: values})


def changing(law, shape):
    """The quantity that a law lets change, whose derivatives it returns."""
    return shape.perimeter_excess if law == "area_sector" else shape.area_deficit


@st.composite
def contacts(draw, size=(2, 6), gap=0.8, indentation=(1e-3, 0.02)):
    """Contacts at least `gap` apart, in any order, indentations in units of a random radius.

    The defaults leave room for every law: sectors that keep their area exist only up to
    indentations of about R gap^2/24.
    """
    z = draw(st.integers(*size))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    weight = rng.random(z)
    opening = gap + (2 * np.pi - z * gap) * weight / weight.sum()
    radius = rng.uniform(0.3, 3.0)
    order = rng.permutation(z)
    return Contacts(
        radius,
        (rng.uniform(-np.pi, np.pi) + np.cumsum(opening))[order],
        radius * rng.uniform(*indentation, z),
    )


def regular_polygon(n, indentation, radius=1.0):
    return Contacts(radius, 0.1 + 2 * np.pi * np.arange(n) / n, np.full(n, float(indentation)))
