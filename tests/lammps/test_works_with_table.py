"""The tables of docs/works_with.md have a row for each command that is tested, and no other.

Marks and the last sections are of droplets, friction and smooth polygons.
"""

import re
from pathlib import Path

import test_atom_stiffness as values
import test_boxes as boxes
import test_droplet_works_with as space
import test_edge_works_with as edges
import test_films_at_touch as films
import test_friction_works_with as rubbing
import test_outlines as outlines
import test_restart as files
import test_works_with as fresh
import test_works_with_bonds as bonds
import test_works_with_hybrid as hybrid
import test_works_with_outputs as outputs
import test_works_with_plane as plane
import test_works_with_refusals as refusals

MARKS = "°ᶠᵖ"
OF_EDGES = {
    "fix npt, tilted",
    "fix deform, flips",
    "change_box, tilted",
    "neighbor nsq",
    "run every",
    "pair_modify",
}
PAGE = Path(__file__).parents[2] / "docs" / "works_with.md"
OTHERS = {
    "fix property/atom": values.test_as_a_fresh_run,
    "bond_style": bonds.test_bonded_particles_keep_their_contacts,
    "special_bonds": bonds.test_other_factors_are_refused,
    "fix gjf": plane.test_noise,
    "fix wall/flow": plane.test_noise,
    "boxes smaller than a particle": boxes.test_same_as_four_cells,
    "neigh_modify exclude": hybrid.test_excluded_pairs,
    "neigh_modify include": hybrid.test_included_group,
    "comm_modify group": hybrid.test_included_group,
    "pair_style hybrid": hybrid.test_types_without_species,
    "pair_style hybrid/scaled": hybrid.test_scaled,
    "pair_style hybrid/overlay with lj/cut": hybrid.test_overlay_with_lj_cut,
    "pair_style hybrid/overlay with dpd/tstat": hybrid.test_overlay_with_dpd_tstat,
    "pair_style hybrid of two deformable styles": hybrid.test_two_deformable_styles,
    "compute pe/atom": outputs.test_per_atom_energies_and_stress,
    "compute stress/atom": outputs.test_per_atom_energies_and_stress,
    "compute pressure": outputs.test_per_atom_energies_and_stress,
    "compute coord/atom": outputs.test_neighborhoods,
    "compute rdf": outputs.test_neighborhoods,
    "compute msd": outputs.test_neighborhoods,
    **dict.fromkeys(
        (
            *("compute voronoi/atom", "compute orientorder/atom", "compute vacf", "dump grid"),
            *("fix ave/chunk", "fix ave/correlate", "fix ave/grid"),
        ),
        outputs.test_averages,
    ),
    **dict.fromkeys(outputs.REPLICAS, outputs.test_replicas),
    "read_data of a general triclinic box": outputs.test_general_triclinic_box,
    "compute reduce": outputs.test_reduce_of_contacts,
    "fix numdiff": outputs.test_numdiff,
    "dynamical_matrix": outputs.test_dynamical_matrix,
    "compute born/matrix numdiff": outputs.test_born_matrix_by_differences,
    "dump image": outlines.test_ranks_draw_one_picture,
    "compute contact/atom": outputs.test_contacts_of_circles,
    "replicate with adhesion": films.test_replicate,
    "restart": files.test_round_trip,
    "write_data": fresh.test_as_a_fresh_run,
    "rerun": outputs.test_rerun,
    "read_dump": outputs.test_read_dump,
}


def test_rows():
    """Each command once."""
    text = PAGE.read_text().split("## With droplets in three dimensions")[0]
    rows = [line.split(" | ")[0] for line in text.splitlines() if line[:2] == "| "]
    cells = [re.sub("[|`*]", "", cell).strip() for cell in rows]
    marked = [name for cell in cells if cell != "command" for name in cell.split(", ")]
    listed = [name.rstrip(MARKS) for name in marked]
    tested = [*fresh.FIXES, *fresh.COMMANDS, *refusals.REFUSED, *outputs.GRIDS, *OTHERS]
    assert sorted(listed) == sorted(set(tested))


def test_marks():
    """Each command that is tried beside them has the mark, or a row in their section."""
    plane, droplets, polygons, friction = re.split("^## With .*", PAGE.read_text(), flags=re.M)
    names = {
        "°": (droplets, [*space.FIXES, *space.COMMANDS]),
        "ᶠ": (friction, [*rubbing.COMMANDS]),
        "ᵖ": (polygons, [name for name in edges.COMMANDS if name not in OF_EDGES]),
    }
    for mark, (rows, tried) in names.items():
        found = re.findall(rf"([^|,{MARKS}]+)[{MARKS}]*{mark}", re.sub("[`*]", "", plane))
        known = {name.strip() for name in found}
        own = re.sub("[`*]", "", rows)
        assert [name for name in tried if name not in known and name not in own] == []
        assert len(known) > 15
