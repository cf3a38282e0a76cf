"""Any commands given to `sim.lmp`: the state is right, or one line says why there is none."""

import re
from itertools import chain

import lammps_deformable as ld
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

SPECIES = "# UNITS: lj\na 0.45 2 inf\nb 0.6 1 inf\n"
DROPLETS = "# UNITS: lj\na 0.5 inf 0 tension 1\nb 0.7 inf 0 tension 2\n"

# Commands that LAMMPS takes in any order; where it refuses one, the case says nothing of states.
ORDERS = [
    *(["set atom 1 type 2"], ["set atom 2*5 type 1"], ["set group all type/fraction 2 0.3 7"]),
    *(["delete_atoms overlap 0.9 all all"], ["delete_atoms group all"], ["clear"]),
    *(
        ["group g id 2", "delete_atoms group g"],
        ["group h id 3", "delete_atoms group h compress no"],
    ),
    *(
        ["create_atoms 1 single 0.5 0.5 0"],
        ["create_atoms 2 random 2 5 NULL overlap 0.8 maxtry 99"],
    ),
    *(
        ["reset_atoms id"],
        ["reset_atoms id sort yes"],
        ["replicate 2 1 1"],
        ["atom_modify sort 1 1"],
    ),
    *(["change_box all x scale 1.01 remap"], ["change_box all xy delta 0.4 remap"]),
    *(["change_box all x final -2 3 remap"], ["change_box all boundary f p p"]),
    *(["displace_atoms all random 0.02 0.02 0 3"], ["displace_atoms all move 30 -9 0"]),
    *(
        ["displace_atoms all random 1 1 0 3"],
        ["velocity all create 1e-4 5"],
        ["mass 1 2"],
        ["mass * 1"],
    ),
    *(["fix a all nve"], ["fix b all enforce2d"], ["fix c all setforce 0 NULL NULL"], ["unfix a"]),
    *(["fix d all spring/self 0.1", "fix_modify d energy yes"], ["fix e all addforce 1e-4 0 0"]),
    *(["fix f all deformable/wall plane 0 -9 0 1"], ["neigh_modify exclude type 1 1"]),
    *(["timestep 0.01", "run 5"], ["run 0"], ["min_style cg", "minimize 0 1e-6 5 9"]),
    *(["thermo_style one"], ["thermo_modify norm yes"], ["thermo 1"], ["reset_timestep 0"]),
    *(["neighbor 0.3 nsq"], ["comm_style tiled", "balance 1.1 rcb"], ["run_style respa 2 2"]),
    *(["compute v all pressure NULL virial"], ["uncompute v"], ["uncompute deformable_beyond"]),
    *(["pair_coeff * * species a b"], ["pair_style deformable/ring contact radical"]),
    *(["set atom 2 z 0.3"], ["displace_atoms all random 0.02 0.02 0.02 3"]),
    *(["change_box all yz delta 0.4 remap"], ["change_box all z scale 0.99 remap"]),
    *(["pair_style deformable/droplet", "pair_coeff * * space a b"], ["replicate 1 1 2"]),
    *(["fix h all deformable/wall zlo -9"], ["run 20"]),
    *(["pair_style none"], ["pair_style lj/cut 1.0", "pair_coeff * * 1e-9 0.1"], ["units real"]),
]


@pytest.fixture(scope="module")
def saved(host):
    """Folders of compressed packings: radii by species, and by particle; droplets in space."""
    folders = []
    for n, (start, law) in enumerate(
        [
            (ld.bidisperse(10, seed=1), ld.Ring()),
            (ld.polydisperse(8, [0.4, 0.5] * 4, seed=1), ld.Ring()),
            (ld.bidisperse(10, dimension=3, seed=1), ld.Droplet()),
        ]
    ):
        jammed = ld.jam(start).packing
        with ld.Simulation(jammed.at(jammed.phi + 0.01), law) as sim:
            sim.relax().save(host.folder / f"saved{n}")
        folders.append(f"saved{n}")
    return folders


def check(answer):
    if "refused" in answer:
        return
    if "error" in answer:
        assert re.match(r"(Lammps|Parameter)Error: [^\n]{10,1000}$", answer["error"])
        return
    assert len(set(answer["atoms"])) == 1
    if answer["unsaved"]:
        return
    # balanced contacts are known to 1e-8 of their forces
    stress, again = (np.array(each) for each in answer["stress"])
    largest = np.abs(stress).max()
    np.testing.assert_allclose(again, stress, rtol=0, atol=1e-6 * largest + 1e-13)
    assert answer["energy"][1] == pytest.approx(answer["energy"][0], rel=1e-6, abs=1e-15)


@pytest.mark.parametrize("examples", [40, pytest.param(1000, marks=pytest.mark.slow)])
def test_states(host, saved, examples):
    @settings(max_examples=examples, deadline=None)
    @given(st.sampled_from(saved), st.lists(st.sampled_from(ORDERS), min_size=1, max_size=6))
    def answers(folder, orders):
        commands = [*chain.from_iterable(orders)]
        files = {"species": SPECIES, "space": DROPLETS}
        check(host.answer(commands, files, load=folder))

    answers()
