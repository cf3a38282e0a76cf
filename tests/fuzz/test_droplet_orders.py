"""Droplets in three dimensions: any arguments, boxes and positions, and commands in any order.

An error of one line, or a run with finite numbers.
"""

from itertools import chain

import pytest
from grammar import numbers, positive, words_of
from hypothesis import given, settings
from hypothesis import strategies as st
from test_commands import FILES, GROUPS, RUNS, TYPES, check

SPECIES = """# UNITS: lj
a 1.0 inf 0 tension 1.0
b 1.2 inf 0 tension 0.5
c 0.2 inf 0 tension 1.0
d 1.0 inf 0 tension 100.0
e 5.0 inf 0 tension 0.05
soft 1.0 2.0 0 tension 1.0
ring 1.0 inf 1.0
skinned 1.0 inf 0 0.1 tension 1.0
"""
GOOD = "abcde"


def scene(box="block -4 4 -4 4 -4 4", boundary="p p p", atoms="atomic", droplets=None):
    """Droplets in a box; those of the default touch, each two others."""
    droplets = droplets or [(1, 0, 0, 0), (2, 1.95, 0, 0), (1, 0.9, 1.7, 0.3)]
    return [
        *("units lj", "dimension 3", f"boundary {boundary}", f"atom_style {atoms}"),
        *("atom_modify map yes", "box tilt large"),
        *(f"region box {box}", "create_box 2 box"),
        *([] if atoms == "sphere" else ["mass * 1.0"]),
        *(f"create_atoms {kind} single {x!r} {y!r} {z!r}" for kind, x, y, z in droplets),
    ]


PAIR_STYLES = st.one_of(
    words_of("reach", "balance", "radius", "type", "atom", "contact"),
    st.tuples(numbers, positive).map(lambda v: ["reach", v[0], "balance", v[1], "20"]),
    st.tuples(numbers, numbers).map(lambda v: ["balance", *v]),
    st.sampled_from([[], ["reach", "0.3"], ["radius", "atom"], ["balance", "1e-12", "50"]]),
).map(lambda words: " ".join(["deformable/droplet", *words]))
NAMES = st.lists(
    st.sampled_from([*GOOD, *GOOD, "soft", "ring", "skinned", "NULL", "none"]), max_size=3
)
PAIR_COEFFS = st.one_of(
    st.tuples(TYPES, TYPES, FILES, NAMES.map(" ".join)).map(" ".join),
    st.tuples(*[st.sampled_from(GOOD)] * 2).map("* * species {0[0]} {0[1]}".format),
)
SOME = [40, pytest.param(1500, marks=pytest.mark.slow)]


@pytest.mark.parametrize("examples", SOME)
def test_styles(host, examples):
    @settings(max_examples=examples, deadline=None)
    @given(PAIR_STYLES, PAIR_COEFFS, st.sampled_from(["atomic", "sphere", "atomic"]))
    def answers(style, coeff, atoms):
        commands = [*scene(atoms=atoms), f"pair_style {style}", f"pair_coeff {coeff}", *RUNS]
        assert check(host.answer(commands, {"species": SPECIES}))

    answers()


# ---- boxes and positions ----

# from far too small to nearly empty
EDGES = st.one_of(st.floats(1.5, 12), st.floats(0.1, 100), st.sampled_from([0.5, 2.0, 1e4]))
TILTS = st.one_of(st.just(0.0), st.floats(-0.5, 0.5), st.floats(-3, 3))  # of an edge
PART = st.floats(0, 1, exclude_max=True)
PLACES = st.one_of(
    st.lists(st.tuples(PART, PART, PART), min_size=1, max_size=2),
    st.lists(st.tuples(PART, PART, PART), min_size=3, max_size=30),
    st.lists(st.tuples(*[st.sampled_from([0.0, 0.25, 0.5, 1e-9])] * 3), min_size=1, max_size=9),
)
BOUNDARIES = st.sampled_from(["p p p"] * 4 + ["f f f", "p p f", "s s s", "p f m"])


@pytest.mark.parametrize("examples", SOME)
def test_boxes(host, examples):
    @settings(max_examples=examples, deadline=None)
    @given(
        st.tuples(EDGES, EDGES, EDGES),
        st.tuples(TILTS, TILTS, TILTS),
        PLACES,
        BOUNDARIES,
        st.tuples(*[st.sampled_from(GOOD)] * 2).map(" ".join),
        st.sampled_from(["neighbor 0.3 bin", "neighbor 0 nsq", "neighbor 2.0 multi"]),
    )
    def answers(edges, tilts, places, boundary, names, neighbor):
        if "f" in boundary or "s" in boundary or "m" in boundary:
            tilts = (0.0, 0.0, 0.0)
        (lx, ly, lz), (a, b, c) = edges, tilts
        xy, xz, yz = a * lx, b * lx, c * ly
        box = f"prism 0 {lx!r} 0 {ly!r} 0 {lz!r} {xy!r} {xz!r} {yz!r}"
        droplets = [
            (1 + n % 2, lx * x + xy * y + xz * z, ly * y + yz * z, lz * z)
            for n, (x, y, z) in enumerate(places)
        ]
        if not any(tilts):
            box = f"block 0 {lx!r} 0 {ly!r} 0 {lz!r}"
        commands = [
            *scene(box, boundary, droplets=droplets),
            *("pair_style deformable/droplet", f"pair_coeff * * species {names}", neighbor),
            *("timestep 0.01", "run 0", "min_style fire", *RUNS),
        ]
        assert check(host.answer(commands, {"species": SPECIES}))

    answers()


# ---- walls ----

REGIONS = """
region room block -1.1 3.3 -1.2 2.9 -1.3 1.4
region ball sphere 2 0 2 0.6 side out
region globe sphere 0.9 0.5 0 3
region tube cylinder x 0.5 0 1.9 INF INF
region post cylinder z 0.9 -1.4 0.5 INF INF side out
region horn cone z 0 0 0.5 3 -4 4
region left plane -0.97 0 0 1 0 0
region slanted plane 0 -0.95 0 0 1 0.4
region corner intersect 2 left slanted
region wedge union 2 left slanted
region hopper intersect 4 room ball post slanted
region both union 2 room tube
region bar prism 2 2.4 2 2.4 -1 1 0.1 0.2 0.1 side out
region egg ellipsoid 0 0 0 3 2 2
region needle block 2 2 1 1 INF INF side out
region inside sphere 0 0 0 0.5
region around sphere 0 0 0 0.2 side out
region none2 block 3 3.5 3 3.5 3 3.5
""".strip().splitlines()
ROOMS = [line.split()[1] for line in REGIONS] + ["none", "box"]
SIDES = ["xlo", "xhi", "ylo", "yhi", "zlo", "zhi", "EDGE"]
SHAPES = [("plane", 6), ("sphere", 4), ("ball", 4), ("cylinder", 7), ("circle", 3), ("plane", 4)]
WALLS = st.one_of(
    st.sampled_from(ROOMS).map(lambda room: [room]),
    *(words_of(*words) for words in (ROOMS, SIDES, ["all", "room", "ball", "move", "plane"])),
    *(st.tuples(st.just(s), *[numbers] * n).map(list) for s, n in SHAPES),
    *(st.tuples(st.just(s), *[positive] * n).map(list) for s, n in SHAPES),
    st.lists(st.tuples(st.sampled_from(SIDES), positive), max_size=4).map(
        lambda pairs: [*chain.from_iterable(pairs)]
    ),
).map(" ".join)


@pytest.mark.parametrize("examples", SOME)
def test_walls(host, examples):
    @settings(max_examples=examples, deadline=None)
    @given(GROUPS, WALLS, st.sampled_from(["f f f", "p p p", "p p f"]))
    def answers(group, wall, boundary):
        commands = [
            *scene(boundary=boundary),
            *("group some id 1", "group none empty", *REGIONS),
            *("pair_style deformable/droplet", "pair_coeff * * species a b", "timestep 0.01"),
            *(f"fix wall {group} deformable/wall {wall}", *RUNS),
        ]
        assert check(host.answer(commands, {"species": SPECIES}))

    answers()


# ---- orders ----


def is_safe(orders):
    """Any LAMMPS may crash where atoms are created beside a fix adapt: it reads memory not set."""
    commands = [*chain.from_iterable(orders)]
    adapts = [n for n, command in enumerate(commands) if command.startswith("fix ad")]
    return not adapts or not any(c.startswith("create_atoms") for c in commands[adapts[0] :])


READY = """
region left plane -0.97 0 0 1 0 0
pair_style deformable/droplet
pair_coeff * * species a b
fix w all deformable/wall left
compute c all deformable/contact
compute sum all reduce sum c_c[5] c_c[4] inputs local
compute virial all pressure NULL virial
compute model all pair deformable/droplet
fix shape all pair 1 deformable/droplet pressure 0 load 0 area 0 contacts 0 contact_area 0
variable v equal c_sum[1]
variable grows equal 1+0.1*step
variable falls equal 1-step
thermo_style custom step pe press c_sum[1]
timestep 0.02
""".strip().splitlines()
ORDERS = [
    ["pair_coeff * * species a b"],
    ["pair_coeff 1 1 species a b"],
    *(["pair_coeff * * species d c"], ["pair_coeff * * species e NULL"]),
    *(["pair_style deformable/droplet reach 0.2", "pair_coeff * * species a b"],),
    *(["pair_style deformable/droplet balance 1e-2 2", "pair_coeff * * species b a"],),
    *(["pair_style deformable/ring"], ["pair_style deformable/ring", "pair_coeff * * species a a"]),
    *(["pair_style none"], ["pair_style zero 2.0", "pair_coeff * *"]),
    [
        *("pair_style hybrid/overlay deformable/droplet lj/cut 2.5",),
        *("pair_coeff * * deformable/droplet species a b", "pair_coeff 1 2 lj/cut 1e-3 1.5"),
    ],
    [
        *("pair_style hybrid deformable/droplet harmonic/cut",),
        *("pair_coeff * * deformable/droplet species a NULL", "pair_coeff * 2 harmonic/cut 1 2"),
    ],
    [
        *("pair_style hybrid/scaled v_grows deformable/droplet",),
        "pair_coeff * * deformable/droplet species a b",
    ],
    ["pair_style hybrid/overlay deformable/droplet deformable/droplet"],
    *(["region left delete"], ["region left plane -0.9 0 0 1 0 0"], ["unfix w"]),
    *(["fix w2 all deformable/wall sphere 0.9 0.5 0 2.6"], ["fix w2 all deformable/wall zlo -0.9"]),
    *(["fix w all deformable/wall left"], ["fix w3 all deformable/wall zlo EDGE"]),
    *(["unfix shape"], ["uncompute sum"], ["compute c2 all deformable/contact"]),
    ["fix ad all adapt 1 pair deformable/droplet tension 1 1 v_grows"],
    ["fix ad all adapt 1 pair deformable/droplet tension * * v_grows scale yes"],
    ["fix ad all adapt 1 pair deformable/droplet tension 1 2 v_grows"],
    ["fix ad all adapt 1 pair deformable/droplet tension * * v_falls"],
    *(["fix ad all adapt 1 pair deformable/droplet kA * * v_grows"], ["unfix ad"]),
    *(["thermo_style one"], ['print "$(v_v)"'], ['print "$(c_virial)"'], ['print "$(f_w[1])"']),
    *(['print "$(c_model[1])"'], ["thermo_style custom step pe c_model[*]"]),
    *(["run 0"], ["run 2"], ["run 20"], ["fix move all nve"], ["fix move all nve/sphere"]),
    *(["minimize 0 1e-8 9 40"], ["min_style fire", "minimize 0 1e-8 50 99"]),
    *(["create_atoms 1 single -0.2 -1.7 0.5"], ["create_atoms 2 random 5 7 NULL overlap 1.5"]),
    *(["delete_atoms overlap 2 all all"], ["delete_atoms group all"]),
    *(["group gone id 2", "delete_atoms group gone compress no"], ["reset_atoms id"]),
    *(["set atom 1 type 2"], ["set group all x 0 y 0 z 0"], ["displace_atoms all move 0 9 -30"]),
    *(["displace_atoms all random 0.5 0.5 0.5 3"], ["velocity all create 1e-2 5"]),
    *(["velocity all set 30 0 0"], ["change_box all x scale 0.5 remap"]),
    *(["change_box all triclinic"], ["change_box all triclinic xy final 3 yz final -3 remap"]),
    *(["change_box all x final -1 1.2 remap y final -1 1 remap"],),
    *(["change_box all x final -50 50 y final -50 50"], ["change_box all boundary f f f"]),
    *(["change_box all boundary s p m"], ["replicate 2 1 1"], ["reset_timestep 0"]),
    *(["write_restart restart"], ["write_data data nofix"], ["atom_modify sort 1 0.5"]),
    ["write_restart r", "clear", "read_restart r"],
    [
        *("write_restart r", "clear", "read_restart r", "pair_style deformable/droplet"),
        *("pair_coeff * * species a b", "compute c all deformable/contact"),
    ],
    [
        *("write_data all.data nocoeff nofix", "clear", "read_data all.data"),
        *("pair_style deformable/droplet radius atom", "pair_coeff * * species a b"),
    ],
    ["dump d all local 1 dump.local c_c[1] c_c[2]", "dump s all custom 1 dump.shape f_shape[2]"],
    *(["undump d"], ["run_style respa 2 2 pair 1"], ["group some id 1"], ["units real"]),
    *(["neigh_modify every 1 delay 0 check no"], ["neighbor 0.3 nsq"], ["neighbor 0 bin"]),
    *(["neigh_modify exclude type 1 1"], ["comm_style tiled", "balance 1.1 rcb"]),
    *(["comm_modify cutoff 0.5"], ["comm_modify cutoff 9"], ["comm_modify mode multi"]),
    *(["fix g all gravity 0.1 vector 0 0 -1"], ["fix d all deform 1 xy erate 0.1 remap x"]),
    *(["fix d all deform 1 x erate -5 remap x"], ["fix npt all nph iso 1 1 1"]),
    *(["newton off"], ["dimension 2"], ["suffix omp"], ["set type 1 diameter 3"], ["mass 1 2"]),
    *(["fix r all deformable/friction 0.5 0.1 0"], ["fix p all deformable/propel 0.1 0.1 7"]),
    *(["fix s all deformable/stick left 3.0 radius 0.4"], ["clear"]),
    *(
        ["compute e all pe/atom", "compute st all stress/atom NULL virial"],
        ["pair_modify shift yes"],
    ),
    *(["group g1 id 1", "compute gg all group/group g1", 'print "$(c_gg)"'], ["kspace_style none"]),
    *(["compute pl all pair/local eng"], ["special_bonds lj 0 0 0"], ["thermo_modify norm yes"]),
]


@pytest.mark.parametrize("examples", [60, pytest.param(4000, marks=pytest.mark.slow)])
def test_any_order(host, examples):
    @settings(max_examples=examples, deadline=None)
    @given(st.lists(st.sampled_from(ORDERS), min_size=2, max_size=12).filter(is_safe))
    def answers(orders):
        commands = [*scene(), *READY, *chain.from_iterable(orders), "run 1"]
        assert check(host.answer(commands, {"species": SPECIES}))

    answers()
