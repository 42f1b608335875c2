# %% [markdown]
# # CFD files to a force table
#
# In a copy of the shipped study, `cases/evie`.

# %%
import pathlib, os, shutil, tempfile

places = [pathlib.Path(os.environ.get("UNDERBODY_STUDY", "cases/evie")), pathlib.Path("../../cases/evie"),
          pathlib.Path("/usr/share/underbody/cases/evie")]
study_folder = pathlib.Path(tempfile.mkdtemp()) / "evie"
shutil.copytree(next(place for place in places if (place / "study.toml").exists()), study_folder,
                ignore=shutil.ignore_patterns(".underbody"))
os.chdir(study_folder)

# %%
import numpy
import underbody

# %%
field = underbody.read("fields/ellipse-h5-p0.csv")
hull = field.zones[0]
pressure = hull["pressure"]                 # Pa; looks into the field's own memory, read only
print(hull.name, len(hull.points), pressure.min(), pressure.max())

loads = underbody.loads(field, symmetry="y")
print(loads.lift_force, loads.force, loads.closure)

batch = underbody.loads("fields/ellipse-h{gap:mm}-p{pitch:deg}.csv", symmetry="y", out="loads.csv")
print(batch.columns["gap"], batch.columns["lift_force"])

# %% [markdown]
# PyVista takes the same memory: `pyvista.wrap(hull.vtk)`, or all zones with `field.vtk`. Debian 12 has no package of it: the tests
# look at these objects with VTK's own `vtkmodules` (`python3-vtk9`), and with PyVista where that is installed. meshio reads what
# `underbody.import_(file, out="body.vtu")` writes.

# %%
import vtkmodules.all
surface = hull.vtk                           # vtkPolyData, no copy
print(surface.GetNumberOfCells(), surface.GetBounds())
