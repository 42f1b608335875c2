"""Fields: arrays without a copy that outlive the field, vtkmodules, foreign readers."""
import gc
import subprocess
import sys

import numpy
import pytest
import underbody

pytestmark = pytest.mark.filterwarnings("ignore::underbody.UnderbodyWarning")

FIELD = "fields/ellipse-h5-p0.csv"


def test_arrays_share_memory_and_keep_it(program):
    field = underbody.read(FIELD)
    zone = field.zones[0]
    name = next(info.name for info in zone.arrays if info.components == 1)
    first, again = zone[name], underbody.read(FIELD).zones[0][name]
    assert first.ctypes.data == zone[name].ctypes.data == field.zones[0][name].ctypes.data
    assert not first.flags.writeable and not first.flags.owndata
    copy = first.copy()
    del field, zone
    gc.collect()
    numpy.random.default_rng(1).random(5_000_000)  # memory that was given back would be written over
    assert (first == copy).all() and (first == again).all()


def test_pressures_sum_to_the_force(program):
    """The force by NumPy alone, over the triangles that the faces are made of."""
    field = underbody.read(FIELD)
    force = numpy.zeros(3)
    for zone in field:
        assert zone.kind in ("wall", "unknown")
        pressure = zone["pressure"]
        ends, corners = zone.offsets, zone.connectivity
        for i in range(len(ends) - 1):
            face = corners[ends[i]:ends[i + 1]]
            at, p = zone.points[face], pressure[face] if len(pressure) == len(zone.points) else pressure[[i] * len(face)]
            for k in range(1, len(face) - 1):
                area = numpy.cross(at[k] - at[0], at[k + 1] - at[0]) / 2
                force -= area * (p[0] + p[k] + p[k + 1]) / 3
    result = underbody.loads(field, zones="*")
    size = numpy.linalg.norm(result.pressure.force)
    sign = numpy.sign(force @ result.pressure.force)  # the file does not say which way its faces look
    assert sign * force == pytest.approx(result.pressure.force, abs=2e-3 * size)


def test_vtk_objects_are_the_same_memory(program):
    pytest.importorskip("vtkmodules", reason="the Debian package python3-vtk9 is not installed")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    field = underbody.read(FIELD)
    zone = field.zones[0]
    surface = zone.vtk
    assert surface.GetClassName() == "vtkPolyData"
    name = zone.arrays[0].name
    arrays = surface.GetPointData().GetArray(name) or surface.GetCellData().GetArray(name)
    assert vtk_to_numpy(arrays).ctypes.data == zone[name].ctypes.data
    del field, zone
    gc.collect()
    assert surface.GetNumberOfPoints() > 0 and surface.GetBounds()[1] > 0
    blocks = underbody.read(FIELD).vtk
    assert blocks.GetNumberOfBlocks() == len(underbody.read(FIELD))


def test_pyvista_takes_the_zones(program):
    pytest.importorskip("vtkmodules", reason="skipped: the Debian package python3-vtk9 is not installed")
    pyvista = pytest.importorskip("pyvista", reason="skipped: PyVista is not installed (Debian 12 has no package of it)")
    field = underbody.read(FIELD)
    zone = field.zones[0]
    wrapped = pyvista.wrap(zone.vtk)
    assert wrapped.n_points == len(zone.points) and numpy.shares_memory(wrapped.points, zone.points)
    assert (wrapped["pressure"] == zone["pressure"]).all()
    assert pyvista.wrap(field.vtk).keys() == [one.name for one in field]


def test_looking_does_not_change_the_field(program):
    field = underbody.read(FIELD)
    before = underbody.loads(field, symmetry="y")
    underbody.probe(field, point="0,0,5 mm", arrays="pressure")
    underbody.info(field)
    assert underbody.loads(field, symmetry="y") == before


def test_meshio_reads_what_import_writes(program, tmp_path):
    meshio = pytest.importorskip("meshio", reason="the Debian package python3-meshio is not installed")
    field = underbody.read(FIELD)
    underbody.import_(FIELD, out=tmp_path / "body.vtu")
    mesh = meshio.read(tmp_path / "body.vtu")
    zone = field.zones[0]
    assert len(mesh.points) == sum(len(one.points) for one in field)
    pressure = mesh.point_data.get("pressure")
    if pressure is not None and len(field) == 1:
        assert numpy.asarray(pressure).ravel().tolist() == zone["pressure"].tolist()


def test_zones_by_name(program):
    field = underbody.read(FIELD)
    name = field.zones[0].name
    assert name in field and field[name].name == name
    with pytest.raises(underbody.UsageError, match="has no zone"):
        field[name + "x"]
    with pytest.raises(underbody.UsageError, match=r"has no array 'presure'\s+hint: did you mean 'pressure'"):
        field[name]["presure"]


def test_import_is_quick_and_leaves_vtkmodules_alone():
    code = "import sys, underbody; print('vtkmodules' in sys.modules, 'meshio' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.split() == ["False", "False"], done.stderr
