# %% [markdown]
# # A study
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
study = underbody.study(".")
study.run(report="out/index.html")
print(len(study.list()["cases"]))
