"""Former names of arguments and attributes work, and warn."""

import warnings
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import deformable
import numpy as np
import pytest

LAW = deformable.Ring(contact="radical")
RADII = [0.5, 0.6, 0.7, 0.5]


@pytest.fixture(scope="module")
def packing() -> deformable.Packing:
    return deformable.polydisperse(4, RADII, phi=0.2)


def formerly(call: Callable[[], Any], former: str, present: str) -> Any:
    """Result of a call that uses a former name, once."""
    with pytest.warns(DeprecationWarning, match=rf"'{former}' .* '{present}'") as caught:
        result = call()
    assert [warning.filename for warning in caught] == [__file__]
    return result


def test_sizes_of_a_packing(packing: deformable.Packing) -> None:
    settings = {"species": [0] * 4, "radii": [0.7], "box": packing.box}
    one = formerly(
        lambda: deformable.Packing(packing.positions, sizes=RADII, **settings),  # type: ignore[call-arg]
        "sizes",
        "particle_radii",
    )
    assert formerly(lambda: one.sizes, "sizes", "particle_radii").tolist() == RADII
    with pytest.warns(DeprecationWarning, match=r"'sizes' .* 'particle_radii'"):
        other = replace(packing, sizes=[0.5] * 4)  # type: ignore[call-arg]
    assert other.radius.tolist() == [0.5] * 4


def test_model_of_a_simulation_and_its_states(packing: deformable.Packing) -> None:
    with formerly(lambda: deformable.Simulation(packing, model=LAW), "model", "law") as sim:
        assert formerly(lambda: sim.model, "model", "law") == LAW
        state = sim.state()
        relaxed = formerly(lambda: sim.relax(bearing=1.0), "bearing", "minimum_contact_force")
    assert relaxed.residual == 0.0
    assert formerly(lambda: state.model, "model", "law") == LAW
    assert formerly(lambda: state.bearing_contacts, "bearing_contacts", "network_contacts") == 0
    contacts = formerly(lambda: state.contacts_seen, "contacts_seen", "particle_contacts")
    assert len(contacts) == 4


def test_names_of_disks(packing: deformable.Packing) -> None:
    with deformable.Disks(packing) as disks:
        state = formerly(lambda: disks.relax(bearing=1.0), "bearing", "minimum_contact_force")
    assert formerly(lambda: state.model, "model", "law") is None
    assert formerly(lambda: state.bearing_contacts, "bearing_contacts", "network_contacts") == 0


def test_model_of_functions(packing: deformable.Packing) -> None:
    start = deformable.bidisperse(2, phi=0.2)
    jammed = formerly(lambda: deformable.jam(start, model=LAW), "model", "law")
    assert np.array_equal(jammed.positions, deformable.jam(start, LAW).positions)
    with deformable.BeadReference(start, deformable.Beads(number=20)) as rings:
        state = rings.state()
    for function in (deformable.predict, deformable.compare):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", deformable.BeyondModelWarning)
            there = formerly(lambda f=function: f(state, model=LAW), "model", "law")  # type: ignore[misc]
        assert type(there) is type(function(state, LAW))


def test_other_names_are_errors(packing: deformable.Packing) -> None:
    with pytest.raises(AttributeError, match=r"'Packing' .* 'size'"):
        _ = packing.size
    with pytest.raises(TypeError, match="mode"):
        deformable.jam(packing, mode=LAW)  # type: ignore[call-arg]
