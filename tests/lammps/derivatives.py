"""Forces and virials by differences of the energy."""

import numpy as np
import pytest

STEP = 1e-6
STRAINS = {
    "isotropic": np.eye(2),
    "xx": np.diag([1.0, 0.0]),
    "yy": np.diag([0.0, 1.0]),
    "xy": np.array([[0.0, 1.0], [0.0, 0.0]]),
}


def assert_forces(scene, x, step=STEP):
    """Central differences for every coordinate, to 1e-7 of the largest force.

    F ~ a^3 with indentations a ~ 0.01: the third derivative leaves step^2/a^2 = 1e-8. Rounding
    leaves 1e-16 U/step, and U is about F a: 1e-12.
    """
    force = scene.evaluate(x).force
    numerical = np.zeros_like(force)
    for index in np.ndindex(x.shape):
        up, down = x.copy(), x.copy()
        up[index] += step
        down[index] -= step
        numerical[index] = -(scene.energy(up) - scene.energy(down)) / (2 * step)
    np.testing.assert_allclose(force, numerical, rtol=0, atol=1e-7 * np.abs(force).max())
    return force


def assert_virial(scene, length):
    """Central differences for strains of a box of width and height `length`, to 1e-7."""
    virial = scene.evaluate().virial
    xx, yy, xy = virial
    back = f"x final 0 {length} y final 0 {length} xy final 0"
    for name, strain in STRAINS.items():
        energy = {}
        for step in (STEP, -STEP):
            h = np.eye(2) + step * strain
            scene.run(
                f"change_box all x final 0 {length * h[0, 0]:.17g} y final 0 "
                f"{length * h[1, 1]:.17g} xy final {length * h[0, 1]:.17g} remap units box"
            )
            energy[step] = scene.energy()
            scene.run(f"change_box all {back} remap units box")
        numerical = -(energy[STEP] - energy[-STEP]) / (2 * STEP)
        expected = np.sum(strain * np.array([[xx, xy], [xy, yy]]))
        # strains of 1e-6 move contacts by 1e-6: as for forces
        assert numerical == pytest.approx(expected, abs=1e-7 * np.abs(virial).max()), name
