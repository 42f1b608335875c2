"""The module's figures are the command line's, to the last bit: both are written out and compared as JSON."""
import json
import pathlib

import numpy
import pytest
import underbody

pytestmark = pytest.mark.filterwarnings("ignore::underbody.UnderbodyWarning")

FIELD = "fields/ellipse-h5-p0.csv"


def plain(result):
    return json.loads(json.dumps(result.to_dict()))


def test_loads_of_a_path(program):
    assert plain(underbody.loads(FIELD, symmetry="y")) == program.json("loads", FIELD, "--symmetry", "y")


def test_loads_of_a_field_in_memory(program):
    field = underbody.read(pathlib.Path(FIELD))
    result = underbody.loads(field, symmetry="y", stations=5, speed="0.5 m/s", density=998)
    line = program.json("loads", FIELD, "--symmetry", "y", "--stations", "5", "--speed", "0.5", "--density", "998")
    assert plain(result) == line
    assert result.lift_force == line["lift_force"]
    assert isinstance(result.force, numpy.ndarray) and result.force.tolist() == line["force"]
    assert result.coefficients.lift == line["coefficients"]["lift"]


@pytest.mark.parametrize("file", ["openfoam/ascii", "ensight/ascii.encas", "fluent_legacy/single.cas"])
def test_loads_of_fields_with_volumes(program, data, file):
    path = data / file
    if not path.exists():
        pytest.skip(f"{path} is not here")
    assert plain(underbody.loads(underbody.read(path), zones="*")) == program.json("loads", path, "--zones", "*")


def test_a_batch_gives_its_table(program, tmp_path):
    pattern = "fields/ellipse-h{gap:mm}-p{pitch:deg}.csv"
    result = underbody.loads(pattern, symmetry="y")
    assert plain(result) == program.json("loads", pattern, "--symmetry", "y")
    lifts = [one["lift_force"] for one in result.to_dict()["files"]]
    assert result.columns["lift_force"].tolist() == lifts
    assert result.columns["gap"].min() > 0


def test_body(program):
    result = underbody.body("shapes/ellipse.toml", gap="5 mm", panels=300)
    assert plain(result) == program.json("body", "shapes/ellipse.toml", "--gap", "5 mm", "--panels", "300")
    surface = result.surface
    a, b, c = (surface.points[surface.triangles[:, k]] for k in range(3))
    volume = numpy.einsum("ij,ij->", a, numpy.cross(b, c)) / 6  # closed, normals outward: the divergence theorem
    assert volume == pytest.approx(result.volume, rel=2e-3)
    assert surface.points[:, 2].min() == pytest.approx(0.005, abs=1e-9)
    assert len(surface.patch) == len(surface.triangles) == sum(patch.faces for patch in result.patches)


def test_table_values_are_those_of_the_command(program):
    gaps = [0.0021, 0.005, 0.0173]
    chosen = {"where": "variant=ellipse, mesh=medium, pitch=0, speed=0.5", "axes": "gap"}
    line = program.json("table", "at", "forces.csv", "--where", chosen["where"], "--axes", "gap", "--quantity",
                        "lift_force", *(f"gap={gap}" for gap in gaps))
    table = underbody.table("forces.csv", **chosen)
    found = table.at(gap=gaps)
    assert found.value.tolist() == [one["value"] for one in line["values"]]
    assert found.sigma.tolist() == [one["sigma"] for one in line["values"]]
    assert found.slope["gap"].tolist() == [one["slope"]["gap"] for one in line["values"]]
    assert table(gap=gaps).tolist() == found.value.tolist()
    again = underbody.table.at("forces.csv", *({"gap": gap} for gap in gaps), quantity="lift_force", **chosen)
    assert plain(again) == line


def test_two_axes_by_name_broadcast(program, tmp_path):
    underbody.loads("fields/ellipse-h{gap:mm}-p{pitch:deg}.csv", symmetry="y", out=tmp_path / "loads.csv")
    table = underbody.table(tmp_path / "loads.csv", axes="gap,pitch", kind="gp")
    gaps = numpy.linspace(0.003, 0.02, 7)
    pitches = numpy.radians([-1.0, 0.5])
    grid = table(gap=gaps[:, None], pitch=pitches)
    assert grid.shape == (7, 2)
    words = [f"gap={float(gap)!r},pitch={float(pitch)!r}" for gap in gaps for pitch in pitches]
    line = program.json("table", "at", tmp_path / "loads.csv", "--axes", "gap,pitch", "--kind", "gp",
                        "--quantity", table.quantity, *words)
    assert grid.ravel().tolist() == [one["value"] for one in line["values"]]
    assert table(gap="5 mm", pitch="1 deg") == table(gap=0.005, pitch=numpy.radians(1.0))
    assert table(numpy.array([[0.005, 0.0]]))[0] == table(gap=0.005, pitch=0)
    # However the same points lie in memory, by place or by name, with one number for all of them, and none at all.
    points = numpy.stack(numpy.broadcast_arrays(gaps[:, None], pitches), axis=-1)
    flat = points.reshape(-1, 2)
    for same in (table(points), table(numpy.asfortranarray(points)), table(gap=points[..., 0], pitch=points[..., 1]),
                 table(flat[::-1])[::-1].reshape(7, 2), table(gap=flat[:, 0], pitch=flat[:, 1].copy()).reshape(7, 2)):
        assert (same == grid).all()
    assert (table(gap=gaps, pitch=pitches[0]) == grid[:, 0]).all()
    assert (table.at(flat).value == grid.ravel()).all() and (table.slopes(flat)["pitch"] == table.at(flat).slope["pitch"]).all()
    assert table(flat[:0]).shape == (0,) and table(gap=[], pitch=0).shape == (0,)
    for wrong in (flat[:, :1], numpy.zeros((3, 3)), 0.005):
        with pytest.raises(underbody.UsageError, match="one column for each axis"):
            table(wrong)
    # The slope of the value along the gap, by differences.
    step = 1e-6
    slope = (table(gap=gaps + step, pitch=0) - table(gap=gaps - step, pitch=0)) / (2 * step)
    assert table.slopes(gap=gaps, pitch=0)["gap"] == pytest.approx(slope, rel=1e-4, abs=1e-4)
    equilibria = table.equilibria(weight="0.3 N", held={"pitch": 0})
    assert plain(equilibria) == program.json("table", "equilibria", tmp_path / "loads.csv", "--axes", "gap,pitch",
                                             "--kind", "gp", "--weight", "0.3 N", "--held", "pitch=0")


def test_simulate(program):
    result = underbody.simulate("glide.toml", start={"gap": "4 mm", "heave_velocity": 0}, duration=5, step="0.1 s")
    words = ["simulate", "glide.toml", "--from", "gap=4 mm,heave_velocity=0", "--for", "5", "--step", "0.1 s"]
    assert plain(result) == program.json(*words)
    assert result.columns["time"][-1] == pytest.approx(5)
    assert len(result.columns["gap"]) == len(result.columns["time"])


def test_region(program):
    options = {"axes": {"gap": ("1 mm", "100 mm"), "heave_velocity": (-0.02, 0.02)}, "grid": "20x20"}
    result = underbody.region("glide.toml", **options)
    words = ["region", "glide.toml", "--axes", "gap=1 mm:100 mm,heave_velocity=-0.02:0.02", "--grid", "20x20"]
    assert plain(result) == program.json(*words)
    classes = result.columns["class"]
    assert len(classes) == 400
    for one in result.to_dict()["classes"]:
        assert classes.count(one["name"]) / 400 == pytest.approx(one["fraction"], abs=1e-12)


def test_models(program):
    model = underbody.model("heave/model.toml")
    assert model.quantities == ["lift_force"]
    lift = model.table(axes="gap")
    assert plain(lift.equilibria()) == program.json("table", "equilibria", "heave/model.toml", "--axes", "gap")
    assert lift(gap="20 mm") == program.json("table", "at", "heave/model.toml", "gap=20 mm", "--axes", "gap")["value"]
    model = underbody.model(pathlib.Path("glide.toml"))
    assert plain(model.region(grid="10x10")) == program.json("region", "glide.toml", "--grid", "10x10")
    with pytest.raises(underbody.InputError):
        underbody.model("nothing.toml")


def test_predict_and_discover(program, tmp_path):
    before = underbody.predict("heave/model.toml", data="heave")
    assert plain(before) == program.json("predict", "heave/model.toml", "--data", "heave")
    found = underbody.discover("heave/model.toml", data=pathlib.Path("heave"), out=tmp_path / "found")
    line = program.json("discover", "heave/model.toml", "--data", "heave", "--out", tmp_path / "again")
    assert plain(found) == line
    assert found.verdict == "effect"
    after = underbody.predict(tmp_path / "found" / "model.toml", data="heave")
    assert after.channels.gap.rmse < before.channels.gap.rmse


def test_studies(program):
    study = underbody.study(".")
    assert plain(study.list()) == program.json("study", "list", ".")
    assert sorted(underbody.study.__dict__) and callable(underbody.study.run)
