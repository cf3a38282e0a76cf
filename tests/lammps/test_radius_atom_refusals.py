"""Radii of atom_style sphere that are not allowed."""

import numpy as np
from laws import RADICAL
from scene import BOX, SPECIES, Scene
from test_radius_atom import styles
from test_refusals import refuses, two_particles


def test_atoms_without_radii():
    lmp = two_particles()
    lmp.command(f"pair_style {RADICAL} radius atom")
    lmp.command(f"pair_coeff * * {SPECIES} any any")
    with refuses("'radius atom'.*atomic"):
        lmp.command("run 0")


@styles
def test_radii_that_are_none(style):
    x = np.array([[0.0, 0.0], [1.1, 0.0]])
    for radius, message in (
        (0.0, "Atom 2 .*radius of 0:"),
        (-0.1, "Atom 2 .*radius of -0.1:"),
        (np.nan, "Atom 2 .*radius of nan:"),
        (np.inf, "Atom 2 .*radius of inf.*species any"),
        (0.81, "Atom 2 .*radius of 0.81.*species any.*0.8"),
    ):
        scene = Scene(x, ["any"] * 2, BOX, f"{style} radius atom", radii=[0.5, radius])
        with refuses(message):
            scene.energy()


def test_largest_radius_is_named_and_rounding_allowed():
    """0.8 may be read back as slightly more."""
    x = np.array([[-1.5, 0.0], [0.0, 0.0], [1.6, 0.0]])

    def scene(radii):
        return Scene(x, ["any"] * 3, BOX, f"{RADICAL} radius atom", radii=radii)

    with refuses("Atom 2 .*0.9"):
        scene([0.81, 0.9, 0.85]).energy()
    scene([0.5, np.nextafter(0.8, 1.0), 0.5]).energy()


def test_radius_within_the_skin():
    x = np.array([[0.0, 0.0], [1.1, 0.0]])
    scene = Scene(x, ["anysoft"] * 2, BOX, f"{RADICAL} radius atom", radii=[0.5, 0.05])
    with refuses("Atom 2 .*0.05.*skin of species anysoft"):
        scene.energy()
