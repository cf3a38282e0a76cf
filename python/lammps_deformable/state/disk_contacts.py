"""Contacts of soft disks, as pictures show them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..model.packing import Packing
from .contact_forces import ContactForces

Floats = NDArray[np.float64]


def halves(packing: Packing, contacts: ContactForces) -> list[tuple[Floats, Floats]]:
    """For each disk, where its contacts are in the middle of their overlaps, and their forces."""
    disk, _, vector, part = _sides(contacts)
    push = np.hypot(*contacts.force.T)
    ends = packing.positions[disk] + part[:, None] * vector
    forces = np.append(push, push[contacts.j >= 0])
    number = len(packing)
    return list(zip(_of_each(disk, number, ends), _of_each(disk, number, forces), strict=True))


def chords(packing: Packing, contacts: ContactForces) -> list[list[Floats]]:
    """For each disk, the lines on which its circle crosses those of others, and walls.

    At the distance d of the centers it is (d^2 + R^2 - R'^2)/(2 d) from the center of R.
    """
    disk, other, vector, _ = _sides(contacts)
    radius, d = packing.radius, np.hypot(*vector.T)
    r = radius[disk]
    height = np.where(other < 0, d, (d**2 + r**2 - radius[other] ** 2) / (2.0 * d))
    out = vector / d[:, None]
    along = np.sqrt(np.maximum(r**2 - height**2, 0.0))[:, None] * (out[:, ::-1] * [-1.0, 1.0])
    middle = packing.positions[disk] + height[:, None] * out
    lines = np.stack([middle - along, middle + along], axis=1)
    return [list(each) for each in _of_each(disk, len(packing), lines)]


def _sides(contacts: ContactForces) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats, Floats]:
    """Disk, other one, vector and part of both sides of contacts, see `ContactForces`."""
    i, j, vector, part, *_ = contacts
    pair = j >= 0
    return (
        np.append(i, j[pair]),
        np.append(j, i[pair]),
        np.concatenate([vector, -vector[pair]]),
        np.append(part, 1.0 - part[pair]),
    )


def _of_each(disk: NDArray[np.int64], number: int, values: Floats) -> list[NDArray[Any]]:
    """The values of the sides of each disk."""
    order = np.argsort(disk, kind="stable")
    return np.split(values[order], np.searchsorted(disk[order], np.arange(1, number)))
