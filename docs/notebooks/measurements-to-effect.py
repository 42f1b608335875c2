# %% [markdown]
# # Measurements to the missing effect
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
before = underbody.predict("heave/model.toml", data="heave")
found = underbody.discover("heave/model.toml", data="heave", out="found")
after = underbody.predict("found/model.toml", data="heave")
print(found.verdict, [effect.name for effect in found.effects])
print(before.channels.gap.rmse, after.channels.gap.rmse)
