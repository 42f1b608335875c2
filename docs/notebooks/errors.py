# %% [markdown]
# # When something is wrong
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
try:
    underbody.loads("fields/ellipse-h5-p0.csv", symmetry="y", density="5 mm")
except underbody.UsageError as error:
    print(error, error.kind)
except underbody.InputError as error:
    print(error.file, error.line, error.hint)
