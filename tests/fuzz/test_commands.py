"""Any arguments of any style, in any order: an error of one line, or a run with finite numbers."""

import re
from itertools import chain
from pathlib import Path

import pytest
from grammar import numbers, positive, words_of
from hypothesis import given, settings
from hypothesis import strategies as st
from lammps_deformable.particles.laws import LAWS
from test_species_file import SCENE

ROOT = Path(__file__).parents[2]
CONTACTS = [name for name in LAWS if name != "sector"]

SPECIES = """# UNITS: lj
a 0.5 1 inf
b 0.6 1 0.3 0.05
c 0.5 inf 1
d 0.5 2 inf
"""

# regions that can be walls, and others
REGIONS = """
region room block -3.9 3.9 -3.9 3.9 -3 3
region disk cylinder z 0 0 3.5 -3 3
region hole cylinder z 2.5 2.5 0.5 -3 3 side out
region left plane -0.45 0 0 1 0 0
region below plane 0 -0.47 0 0 1 0
region corner intersect 2 left below
region slanted plane 0 -0.47 0 0 1 0.4
region pipe cylinder x 0 0 0.48 -3 3
region horn cone z 0 0 0.3 3 -3 3
region away block 3 3.5 3 3.5 -3 3
region flat block -3 3 -3 3 0.2 0.3
region post block 1.4 2.1 -0.5 0.5 INF INF side out
region plate prism -2 -1.9 -1 1 -3 3 0.3 0 0 side out
region needle block 0.9 0.9 0.6 2 INF INF side out
region wedge union 2 left slanted
region both union 2 disk room
region hopper intersect 4 room post plate needle
""".strip().splitlines()
ROOMS = ["room", "disk", "hole", "corner", "slanted", "pipe", "horn", "away", "flat", "box", "none"]
ROOMS += ["post", "plate", "needle", "wedge", "both", "hopper"]

PAIR_STYLES = st.one_of(
    words_of("contact", *CONTACTS, "balance", "reach").map(["deformable/ring"].__add__),
    words_of("contact", "reach").map(["deformable/sector"].__add__),
    st.sampled_from(
        [
            ["deformable/ring"],
            ["deformable/sector"],
            ["deformable/ring", "contact", "balanced", "reach", "0.3"],
            ["deformable/ring", "reach", "0.3", "contact", "balanced", "balance", "1e-6", "9"],
        ]
    ),
    st.tuples(positive, numbers, numbers).map(
        lambda v: ["deformable/ring", "contact", "balanced", "reach", v[0], "balance", *v[1:]]
    ),
).map(" ".join)
TYPES = st.sampled_from(["*", "*", "*", "*", "1", "2", "1*2", "2*", "0", "3", "-1", "x"])
FILES = st.sampled_from(["species", "species", "species", "folder", "nowhere"])
NAMES = st.lists(
    st.sampled_from(["a", "b", "c", "d", "a", "a", "NULL", "e", "1"]), min_size=0, max_size=3
).map(" ".join)
PAIR_COEFFS = st.one_of(
    st.tuples(TYPES, TYPES, FILES, NAMES).map(" ".join),
    st.tuples(*[st.sampled_from("abcd")] * 2).map("* * species {0[0]} {0[1]}".format),
)
SHAPES = [("plane", 4), ("circle", 3), ("disk", 3), ("segment", 4), ("disk", 2)]
WALLS = st.one_of(
    st.tuples(st.sampled_from(ROOMS)).map(list),
    *(words_of(*words) for words in (ROOMS, ["all", "room", "move"])),
    *(st.tuples(st.just(s), *[numbers] * n).map(list) for s, n in SHAPES),
    st.lists(numbers, min_size=6, max_size=8).map(["polygon", "3"].__add__),
).map(" ".join)
STICKS = st.one_of(
    st.tuples(st.sampled_from(ROOMS), numbers).map(list),
    st.tuples(st.sampled_from(ROOMS), positive, st.just("radius"), numbers).map(list),
    words_of("radius", *ROOMS),
).map(" ".join)
COEFFICIENT = st.one_of(positive, positive, numbers, st.sampled_from(["inf", "v_grows", "v_each"]))
RUBS = st.one_of(
    st.tuples(*[COEFFICIENT] * 3).map(list),
    st.tuples(*[COEFFICIENT] * 3, st.just("damp"), COEFFICIENT).map(list),
    st.tuples(*[positive] * 3, st.just("types"), TYPES, TYPES | st.just("wall"), *[COEFFICIENT] * 4)
    .map(list),
    words_of("damp", "types", "wall", "inf", "v_grows", "v_each"),
).map(" ".join)  # fmt: skip
POLYGONS = st.one_of(
    numbers.map(lambda kA: [kA]),
    st.tuples(positive, st.just("rest"), numbers).map(list),
    words_of("rest", "initial"),
).map(" ".join)
GROWTH = st.one_of(
    st.tuples(
        *(st.sampled_from(["1", "2"]), positive, positive, st.just("7")),
        words_of("pressure", "axis", "asymmetry", "random", "stress", "long").map(" ".join),
    ).map(list),
    st.tuples(*[numbers] * 4).map(list),
    words_of("pressure", "axis"),
).map(" ".join)
OUTLINES = st.one_of(st.just(""), numbers.map("points {}".format), words_of("points").map(" ".join))
MINIMIZER = words_of(
    *("memory", "precondition", "dmax", "norm", "springs", "none", "two", "inf", "max")
).map(" ".join)
GROUPS = st.sampled_from(["all", "all", "some", "none", "nobody"])
RUNS = ["run 0", "minimize 0 1e-8 3 6", "fix move all nve", "velocity all set 0.1 0 0", "run 3"]


STYLES = ["ring", "ring contact radical", "ring contact curved", "sector"]


def check(answer):
    if "error" not in answer:
        return answer["finite"]
    # one line of plain characters; LAMMPS adds the command, the address of its manual, or a table
    line, _, rest = answer["error"].partition("\n")
    known = rest == "" or rest.startswith(("Last input line:", "For more information see"))
    known |= line == "ERROR: All pair coeffs are not set. Status:"
    return bool(re.match(r"ERROR(?: on proc 0)?: \w[ -~]{10,600}$", line)) and known


SOME = [30, pytest.param(800, marks=pytest.mark.slow)]


@pytest.mark.parametrize("examples", SOME)
def test_pair_styles(host, examples):
    @settings(max_examples=examples, deadline=None)
    @given(PAIR_STYLES, PAIR_COEFFS)
    def answers(style, coeff):
        commands = [*SCENE, f"pair_style {style}", f"pair_coeff {coeff}", *RUNS]
        assert check(host.answer(commands, {"species": SPECIES}))

    answers()


def beside_regions(*commands):
    return [*SCENE, "group some id 1", "group none empty", *REGIONS, *commands, *RUNS]


@pytest.mark.parametrize("examples", SOME)
def test_walls(host, examples):
    @settings(max_examples=examples, deadline=None)
    @given(GROUPS, WALLS, st.sampled_from(["ring", "sector", "ring contact radical"]))
    def answers(group, wall, style):
        fix = f"fix wall {group} deformable/wall {wall}"
        pair = f"pair_style deformable/{style}", "pair_coeff * * species a d", "neighbor 0.3 bin"
        assert check(host.answer(beside_regions(*pair, fix), {"species": SPECIES}))

    answers()


@pytest.mark.parametrize("examples", SOME)
def test_sticks(host, examples):
    @settings(max_examples=examples, deadline=None)
    @given(GROUPS, STICKS, st.sampled_from(["harmonic/cut", "zero 0.9", "none"]))
    def answers(group, stick, pair):
        coeff = {"harmonic/cut": "pair_coeff * * 1 0.9", "zero 0.9": "pair_coeff * *"}.get(pair, "")
        pair = f"pair_style {pair}", coeff, "comm_modify cutoff 1.5"
        fix = f"fix stick {group} deformable/stick {stick}"
        assert check(host.answer(beside_regions(*pair, fix)))

    answers()


@pytest.mark.parametrize("examples", SOME)
def test_friction(host, examples):
    @settings(max_examples=examples, deadline=None)
    @given(GROUPS, RUBS, st.booleans(), st.sampled_from(STYLES))
    def answers(group, rub, spins, style):
        scene = beside_regions(
            *(f"pair_style deformable/{style}", "pair_coeff * * species a d", "neighbor 0.3 bin"),
            *("variable grows equal 0.1*step", "variable each atom x"),
            *("fix wall all deformable/wall left", f"fix rub {group} deformable/friction {rub}"),
        )
        if spins:
            scene = ["atom_style sphere", *scene]
            scene.remove("mass * 1.0")
            scene[scene.index("fix move all nve")] = "fix move all nve/sphere disc"
        assert check(host.answer(scene, {"species": SPECIES}))

    answers()


@pytest.mark.parametrize("examples", SOME)
def test_growth_outlines_and_minimizer(host, examples):
    @settings(max_examples=examples, deadline=None)
    @given(GROUPS, GROWTH, OUTLINES, MINIMIZER, st.sampled_from(STYLES))
    def answers(group, growth, outline, settings, style):
        pair = f"pair_style deformable/{style}", "pair_coeff * * species a d"
        lines = f"compute lines {group} deformable/outline {outline}"
        for commands in (
            [f"fix grow {group} deformable/proliferate {growth}"],
            [lines, "dump lines all local 1 dump.lines c_lines[*]"],
            ["min_style deformable/lbfgs", f"min_modify {settings}"],
        ):
            scene = beside_regions(*pair, *commands)
            assert check(host.answer(scene, {"species": SPECIES}))

    answers()


def test_each_style_is_drawn():
    sources = "".join(path.read_text() for path in (ROOT / "src").rglob("*.h"))
    styles = set(re.findall(r"Style\((deformable/\w+),", sources))
    styles -= {"deformable/films", "deformable/restart"}  # made by pair styles
    drawn = "".join(path.read_text() for path in Path(__file__).parent.glob("*.py"))
    assert len(styles) > 10
    assert {style for style in styles if style not in drawn} == set()


def rings(molecules, images, places):
    """A data file of beads."""
    rows = [
        f"{n} {molecule} 1 {x} {y} 0 {image[0]} {image[1]} 0"
        for n, (molecule, image, (x, y)) in enumerate(
            zip(molecules, images, places, strict=True), start=1
        )
    ]
    head = f"rings\n\n{len(rows)} atoms\n1 atom types\n-4 4 xlo xhi\n-4 4 ylo yhi\n-0.5 0.5 zlo zhi"
    return head + "\n\nMasses\n\n1 1\n\nAtoms # bond\n\n" + "\n".join(rows) + "\n"


SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
TWO = [*SQUARE, *((x + 2, y + 2) for x, y in SQUARE)]
MOLECULES = st.one_of(
    st.just([1, 1, 1, 1, 2, 2, 2, 2]),
    st.just([5, 5, 5, 5, 3, 3, 3, 3]),
    st.lists(st.integers(-1, 2), min_size=8, max_size=8),
)
IMAGES = st.one_of(
    st.just([(0, 0)] * 8),
    st.lists(st.tuples(*[st.integers(-1, 1)] * 2), min_size=8, max_size=8),
    st.lists(st.tuples(*[st.sampled_from([0, -512, 511])] * 2), min_size=8, max_size=8),
)
PLACES = st.one_of(
    st.just(TWO),
    st.lists(st.tuples(*[st.floats(-4, 3.9)] * 2), min_size=8, max_size=8),
    st.lists(st.sampled_from(SQUARE), min_size=8, max_size=8),
)


@pytest.mark.parametrize("examples", SOME)
def test_polygons(host, examples):
    @settings(max_examples=examples, deadline=None)
    @given(GROUPS, POLYGONS, MOLECULES, IMAGES, PLACES, st.sampled_from(["bond", "atomic"]))
    def answers(group, polygon, molecules, images, places, style):
        commands = [
            *("units lj", "dimension 2", f"atom_style {style}", "comm_modify cutoff 1.5"),
            *("read_data data", "group some id 1:4", "group none empty"),
            *("pair_style zero 0.5", "pair_coeff * *"),
            *(f"fix area {group} deformable/polygon {polygon}", *RUNS),
        ]
        data = rings(molecules, images, places)
        if style == "atomic":
            data = re.sub(r"(?m)^(\d+) -?\d+ 1 ", r"\1 1 ", data.replace("# bond", "# atomic"))
        assert check(host.answer(commands, {"data": data}))

    answers()


EDGES = st.one_of(
    words_of("l", "kr").map(" ".join), numbers, st.sampled_from(["1.05", "1.5", "3.9"])
)
CONTACTS = st.one_of(
    st.tuples(TYPES, TYPES, numbers, numbers).map(" ".join),
    st.tuples(positive, st.floats(0.1, 1.9)).map("* * {0[0]} {0[1]!r}".format),
    words_of("*").map(" ".join),
)
NEAR = [*SQUARE, *((x + 1.2, y + 0.1) for x, y in SQUARE)]


@pytest.mark.parametrize("examples", SOME)
def test_edges(host, examples):
    @settings(max_examples=examples, deadline=None)
    @given(EDGES, CONTACTS, MOLECULES, IMAGES, st.one_of(PLACES, st.just(NEAR)))
    def answers(longest, contacts, molecules, images, places):
        commands = [
            *("units lj", "dimension 2", "atom_style bond", "read_data data"),
            *(f"pair_style deformable/edge {longest}", f"pair_coeff {contacts}", *RUNS),
        ]
        assert check(host.answer(commands, {"data": rings(molecules, images, places)}))

    answers()


# Commands that may come in any order, once everything is defined. They do not remove a compute that
# another one still uses, because any LAMMPS then crashes.
READY = """
region left plane -0.45 0 0 1 0 0
pair_style deformable/ring
pair_coeff * * species a d
fix w all deformable/wall left
fix s all deformable/stick left 3.0 radius 0.4
fix r all deformable/friction 0.5 0.1 0.01 damp 0.1 types 1 wall 0.1 0.1 0 0
compute c all deformable/contact
compute sum all reduce sum c_c[4] c_c[5] inputs local
compute virial all pressure NULL virial
variable v equal c_sum[1]
thermo_style custom step pe press c_sum[1]
""".strip().splitlines()
ORDERS = [
    ["pair_style deformable/ring", "pair_coeff * * species a d"],
    ["pair_style deformable/ring contact radical reach 0.3", "pair_coeff * * species d b"],
    ["pair_style deformable/sector", "pair_coeff * * species a d"],
    ["pair_style deformable/sector", "pair_coeff * * species c c"],
    ["pair_style zero 1.0", "pair_coeff * *"],
    [
        *("pair_style hybrid/overlay deformable/ring zero 1.0", "pair_coeff * * zero"),
        "pair_coeff * * deformable/ring species a NULL",
    ],
    *(["pair_style deformable/ring"], ["pair_style none"], ["pair_coeff * * species b b"]),
    *(["region left delete"], ["region left plane -0.5 0 0 1 0 0"]),
    *(["unfix w"], ["fix w all deformable/wall left"], ["fix w2 all deformable/wall left"]),
    *(["unfix s"], ["fix s all deformable/stick left 3.0 radius 0.4"]),
    *(["unfix r"], ["fix r all deformable/friction inf 0.1 0"], ['print "$(f_r[1])"']),
    *(["fix p all deformable/proliferate 1 0.5 1.0 7 axis stress"], ["unfix p"]),
    *(["compute o all deformable/outline"], ["dump o all local 1 dump.lines c_o[*]"], ["undump o"]),
    *(["min_style deformable/lbfgs"], ["min_style fire"]),
    *(["uncompute sum"], ["compute c2 all deformable/contact"]),
    *(["thermo_style one"], ['print "$(v_v)"'], ['print "$(c_virial)"'], ['print "$(f_w[1])"']),
    *(["run 0"], ["run 2"], ["minimize 0 1e-8 2 4"], ["fix move all nve"]),
    *(["create_atoms 1 single -0.2 1.5 0"], ["delete_atoms overlap 2 all all"]),
    *(
        ["set atom 1 type 2"],
        ["change_box all x scale 0.99 remap"],
        ["displace_atoms all move 0 1 0"],
    ),
    *(["write_restart restart"], ["replicate 2 1 1"], ["reset_atoms id"], ["reset_timestep 0"]),
    *(
        ["dump d all local 1 dump.local c_c[1] c_c[2]"],
        ["undump d"],
        ["dump r all local 1 dump.rub f_r[1]"],
        ["atom_modify sort 1 0.5"],
    ),
    *(["run_style respa 2 2 pair 1"], ["delete_atoms group all"], ["group some id 1"]),
    *(["neigh_modify every 1 delay 0 check no"], ["neighbor 0.3 nsq"], ["write_data data nofix"]),
]


@pytest.mark.parametrize("examples", [30, pytest.param(3000, marks=pytest.mark.slow)])
def test_any_order(host, examples):
    @settings(max_examples=examples, deadline=None)
    @given(st.lists(st.sampled_from(ORDERS), min_size=2, max_size=12))
    def answers(orders):
        commands = [*SCENE, *READY, *chain.from_iterable(orders), "run 1"]
        assert check(host.answer(commands, {"species": SPECIES}))

    answers()


def test_contacts_are_asked_for_between_two_pair_styles(host):
    """Those of a style that is gone: an error, or none if the new one has its place in memory."""
    sector = ["pair_style deformable/sector", "pair_coeff * * species a d"]
    orders = ["write_data data nofix", *sector, 'print "$(v_v)"', *READY[1:3], "run 1"]
    answer = host.answer([*SCENE, *READY, *orders], {"species": SPECIES})
    assert "use 'run 0' first" in answer.get("error", "use 'run 0' first")


def test_nothing_stays_behind(host):
    """Runs and refusals hold no files, and no more memory than LAMMPS itself does."""
    cases = [
        [*SCENE, *READY, "run 1"],
        [*SCENE, *READY[:2], "pair_coeff * * species a e"],
        [*SCENE, *READY, "fix v all deformable/wall nowhere"],
        [*SCENE, *READY, "displace_atoms all move -5 0 0", "run 1"],
    ]
    held = [host.answer(case, {"species": SPECIES}) for _ in range(100) for case in cases]
    warm, end = held[199], held[399]
    assert end["open"] == warm["open"]
    # other styles leave 2 kB a case in the allocator
    assert end["kB"] - warm["kB"] < 10 * 200
