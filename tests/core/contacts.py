"""Random contacts, and the contact laws as functions of them."""

from dataclasses import dataclass, replace

import numpy as np
from hypothesis import strategies as st
from lammps_deformable import core

LAWS = {"sector": core.sector, "area_sector": core.area_sector, "ring": core.ring}


@dataclass(frozen=True)
class Contacts:
    """The contacts of one particle."""

    radius: float
    angle: np.ndarray
    indentation: np.ndarray

    def shape(self, law):
        return LAWS[law](self.radius, self.angle, self.indentation)

    def outline(self, law, points=180):
        return core.outline(law, self.radius, self.angle, self.indentation, points)

    def moved(self, name, contact, step):
        """A copy in which `name` of one contact is changed by `step`."""
        values = getattr(self, name).copy()
        values[contact] += step
        return replace(self, **{name: values})


def changing(law, shape):
    """The quantity that is not conserved; the law returns its derivatives."""
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


IRREGULAR = Contacts(
    1.2, np.array([0.0, 1.3, 2.6, 4.0, 5.2]), np.array([0.02, 0.03, 0.01, 0.03, 0])
)

# kA, kP and tension of rings with a line tension, for a radius of 1
TENSE = {
    "droplet": (np.inf, 0.0, 1.0),
    "stiff droplet": (np.inf, 2.0, 0.3),
    "bubble": (1.0, 0.0, 3.0),
    "stiff bubble": (20.0, 0.0, 0.1),
    "all": (1.0, 0.5, 0.7),
    "nearly none": (1.0, 0.5, 1e-9),
}


def sized(stiffness, radius):
    """The same in units of another radius: kA R^4, kP R^2 and tension R over the first of them."""
    kA, kP, tension = stiffness
    return kA, kP * radius**2, tension * radius**3


# kA and kP
STIFFNESSES = {
    "soft perimeter": (1.0, 0.01),
    "equal": (1.0, 1.0),
    "stiff perimeter": (0.5, 1e3),
    "area conserved": (np.inf, 0.7),
    "perimeter conserved": (2.0, np.inf),
}
stiffnesses = st.sampled_from([*STIFFNESSES.values()])


def soft_ring(contacts, kA, kP, skin=0.0):
    return core.soft_ring(contacts.radius, contacts.angle, contacts.indentation, kA, kP, skin)
