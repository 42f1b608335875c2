# %% [markdown]
# # A table to numbers
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
underbody.loads("fields/ellipse-h{gap:mm}-p{pitch:deg}.csv", symmetry="y", out="loads.csv")

# %%
lift = underbody.table("loads.csv", axes="gap", where="pitch=0")
print(lift(gap="5 mm"), lift.at(gap=[0.004, 0.005, 0.006]).sigma, lift.slopes(gap=0.005)["gap"])
many = lift(gap=numpy.linspace(0.002, 0.05, 1_000_000))
print(many.shape, lift.equilibria(weight="0.3 N").equilibria)
lift.export(format="c", out="lift.h", max_error="0.5 %")

# %% [markdown]
# Outside its points a table does what its `range` says and warns. An axis that is not named is held as on the command line.
