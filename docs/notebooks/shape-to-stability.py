# %% [markdown]
# # Shape to stability
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
body = underbody.body("shapes/ellipse.toml", gap="5 mm")
print(body.volume, body.buoyancy, len(body.surface.triangles))

model = underbody.model("model.toml")        # forces from tables, scaled to its speed
motion = model.simulate(start={"gap": "4 mm", "heave_velocity": 0}, duration=20, step="0.1 s")
print(motion.end, motion.columns["time"][-1], motion.columns["gap"][-1])
region = model.region(axes={"gap": ("1 mm", "100 mm"), "heave_velocity": (-0.02, 0.02)}, grid="60x60", out="region.png")
print({one.name: one.fraction for one in region.classes})
