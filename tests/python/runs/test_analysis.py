"""Recorded runs in other programs: MDAnalysis, pandas, VTK."""

import shutil
from pathlib import Path
from xml.etree import ElementTree

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.state.recorded import numbers_of, particle_values
from protocol_helpers import written

pytest.importorskip("MDAnalysis")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[ld.State]]:
    """A recorded motion, with the state before its first step."""
    folder = tmp_path_factory.mktemp("run")
    fluid = ld.bidisperse(16, phi=0.7, tilt=0.3, seed=2).push_off()
    with ld.Simulation(fluid, ld.Ring()) as sim:
        return folder, list(sim.run(60, temperature=1e-5, every=20, seed=1, record=folder))


def test_universe_of_a_run(run: tuple[Path, list[ld.State]]) -> None:
    folder, states = run
    universe = ld.Run(folder).to_mdanalysis()
    assert len(universe.trajectory) == len(states) == 4
    assert np.array_equal(universe.atoms.radii, states[0].packing.radii)
    for frame, state in zip(universe.trajectory, states, strict=True):
        one = state.to_mdanalysis()
        assert frame.time == pytest.approx(state.time)
        assert frame.dimensions == pytest.approx(one.dimensions, rel=1e-6)
        assert frame.positions == pytest.approx(one.atoms.positions, abs=1e-5)
        assert frame.velocities == pytest.approx(one.atoms.velocities, rel=1e-6)
        for name, values in particle_values(state).items():
            assert frame.data[name] == pytest.approx(values, rel=1e-12)
    assert np.array_equal(universe.atoms.types, one.atoms.types)
    assert np.array_equal(universe.atoms.ids, one.atoms.ids)


def test_frames_without_a_clock_are_counted(state: ld.State, tmp_path: Path) -> None:
    written([state, state], tmp_path)
    universe = ld.Run(str(tmp_path)).to_mdanalysis()
    assert [frame.time for frame in universe.trajectory] == [0.0, 1.0]


def test_frames_that_are_not_complete_are_left_out(
    run: tuple[Path, list[ld.State]], tmp_path: Path
) -> None:
    """A run may be read while it goes on, or after it was killed."""
    shutil.copytree(run[0], tmp_path, dirs_exist_ok=True)
    text = (tmp_path / "trajectory.lammpstrj").read_text()
    (tmp_path / "trajectory.lammpstrj").write_text(text + text[: len(text) // 4])
    universe = ld.Run(tmp_path).to_mdanalysis()
    for each in (universe, universe.copy()):
        assert len(each.trajectory) == 4
        assert len([frame.frame for frame in each.trajectory]) == 4
        assert each.trajectory[-1].time == pytest.approx(run[1][-1].time)


def test_table(run: tuple[Path, list[ld.State]]) -> None:
    pytest.importorskip("pandas")
    recorded = ld.Run(run[0])
    table, states = recorded.table(), list(recorded)
    assert table["frame"].tolist() == list(range(len(states)))
    kinds = {"particles": "i", "beyond": "i", "stalled": "b", "phi": "f", "shear_strain": "f"}
    assert {name: table[name].dtype.kind for name in kinds} == kinds
    with pytest.raises(KeyError, match=r"no column 'presure': there are .* pressure, "):
        _ = table["presure"]
    memory = ld.Run(states).table()
    assert memory.keys() == table.keys()
    for name, values in table.items():
        np.testing.assert_array_equal(memory[name], values)
    for name, value in numbers_of(run[1][-1]).items():
        if isinstance(value, str):
            assert table[name][-1] == value
            continue
        expected = np.nan if value is None else value
        assert table[name][-1] == pytest.approx(expected, rel=1e-14, nan_ok=True)
    assert recorded[1:3].table()["frame"].tolist() == [1, 2]
    frame = table.to_pandas()
    assert frame.index.name == "frame"
    assert frame["phi"].tolist() == table["phi"].tolist()
    shapes = [state.shape_parameter.mean() for state in states]
    assert table["shape_parameter"].tolist() == pytest.approx(shapes)


def test_columns_of_a_table(run: tuple[Path, list[ld.State]], tmp_path: Path) -> None:
    """Of the frames that are complete: a killed run may have more rows."""
    pytest.importorskip("pandas")
    shutil.copytree(run[0], tmp_path, dirs_exist_ok=True)
    recorded = ld.Run(tmp_path)
    states = list(recorded)
    (tmp_path / "series.csv").open("a").write(f"{len(states)},16,1.0\n")
    found = recorded.table(
        smallest=lambda state: state.arc_radii.min(), name=lambda state: type(state).__name__
    )
    assert len(recorded.table()["phi"]) == len(found["name"]) == len(states)
    assert found["smallest"].tolist() == [state.arc_radii.min() for state in states]
    assert set(found["name"]) == {"State"}
    told = "column low must be a function of a state, such as .*, not 'pressure'"
    with pytest.raises(ld.ParameterError, match=told):
        recorded.table(low="pressure")
    with pytest.raises(ld.ParameterError, match="each table has a column phi"):
        recorded.table(phi=lambda state: state.packing.phi)


def test_export_of_a_run(run: tuple[Path, list[ld.State]], tmp_path: Path) -> None:
    folder, states = run
    ld.Run(folder).export(tmp_path / "shapes.pvd")
    ld.Run(states).export(tmp_path / "again.pvd")
    root = ElementTree.parse(tmp_path / "shapes.pvd").getroot()
    assert (root.tag, root.get("type")) == ("VTKFile", "Collection")
    listed = [(each.get("timestep"), each.get("file")) for each in root.iter("DataSet")]
    assert listed == [(str(s.time), f"shapes_{n:04d}.vtp") for n, s in enumerate(states)]
    assert {path.name for path in tmp_path.glob("shapes_*")} == {name for _, name in listed}
    vtk = pytest.importorskip("vtkmodules.vtkIOXML")
    for n, state in enumerate(states):
        for name in ("shapes", "again"):
            reader = vtk.vtkXMLPolyDataReader()
            reader.SetFileName(str(tmp_path / f"{name}_{n:04d}.vtp"))
            reader.Update()
            pressure = reader.GetOutput().GetCellData().GetArray("pressure")
            assert pressure.GetValue(3) == pytest.approx(state.pressures[3], rel=1e-6)


def test_refusals(state: ld.State, tmp_path: Path) -> None:
    with pytest.raises(ld.ParameterError, match=r"\.pvd, not .*a\.vtp"):
        ld.Run([state]).export(tmp_path / "a.vtp")
    with pytest.raises(ld.ParameterError, match="at least one state"):
        ld.Run([]).export(tmp_path / "a.pvd")
    for arguments in ((3, "a.pvd"), ([state], 3), ([state.packing], tmp_path / "a.pvd")):
        with pytest.raises(ld.ParameterError, match=r"must be of the kind .* not (3|a Packing)"):
            ld.Run(arguments[0]).export(arguments[1])
    assert not list(tmp_path.iterdir())
    (tmp_path / "gone").mkdir()
    state.save(tmp_path / "gone")
    gone = ld.Run(tmp_path / "gone")
    (tmp_path / "gone" / "summary.json").unlink()
    for read in (gone.to_mdanalysis, gone.table, gone.__iter__, gone.__len__):
        with pytest.raises(ld.FileError, match="gone'"):
            read()
    with pytest.raises(ld.ParameterError, match=r"source .* not 3"):
        ld.Run(3)
    state.save(tmp_path)
    with pytest.raises(ld.FileError, match=r"trajectory\.lammpstrj is missing"):
        ld.Run(tmp_path).to_mdanalysis()


def test_a_universe_begins_at_the_time_of_the_first_frame(tmp_path: Path) -> None:
    with ld.Simulation(ld.bidisperse(8, seed=1).push_off(), ld.Ring()) as sim:
        sim.run(20, timestep=0.1)
        run = sim.run(20, timestep=0.1, every=10, record=tmp_path)
    times = [frame.time for frame in ld.Run(tmp_path).to_mdanalysis().trajectory]
    assert times == pytest.approx([state.time for state in run])
    assert times[0] == pytest.approx(2.0)
