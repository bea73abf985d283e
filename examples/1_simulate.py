# %% [markdown]
# # 1. Simulate: a crowd, a depth camera, and the truth
#
# Each example is a script that runs alone (`python examples/1_simulate.py`) and a notebook: open it in VS Code, or
# in Jupyter with jupytext. Its picture goes to `pictures/` in the folder that it is run in.
#
# The scene `wall` is one of the sixteen that come along (`unocclude simulate --help` lists them): two people cross
# behind a wall. Seed 0 is the scene as it is written; any other seed is the same scene on another day.

# %%
from pathlib import Path

import matplotlib.pyplot as plt

import unocclude

recording = unocclude.simulate("wall", seed=1)
print(recording)
recording

# %% [markdown]
# A frame is a depth image in metres, `[row, column]`, NaN where nothing came back. `recording.camera` turns it into
# points.

# %%
depth = recording.frames[50].depth
points = recording.camera.world_points(depth)
print(f"depth image {depth.shape}, from {depth[depth > 0].min():.1f} to {depth[depth > 0].max():.1f} m")
print(f"point behind pixel (80, 90): {points[80, 90].round(2)} m; z is up, the ground is z = 0")

# %% [markdown]
# The recording also knows what the camera cannot see: behind every pixel the exact material point of a body, and
# every person's depth as if nothing stood before it (the X-ray twin). So for every frame it is known how much of
# whom is hidden, which no real recording can tell. [docs/recording.md](../docs/recording.md) has the rest: exact
# positions, flow between any two frames, tracks.

# %%
visibility = unocclude.visibility_of(recording)
for objectid, hidden in zip(visibility.ids, visibility.hidden, strict=True):
    print(f"person {objectid} is hidden in {hidden.sum()} of {len(hidden)} frames")

# %%
plt.style.use("tableau-colorblind10")
figure, panels = plt.subplot_mosaic("abc;ddd", figsize=(12, 6), layout="constrained")
for panel, frame in zip("abc", (20, 40, 60), strict=True):
    recording.plot(frame, axes=panels[panel])
for objectid, seen, whole in zip(visibility.ids, visibility.seen, visibility.unoccluded, strict=True):
    panels["d"].plot(100 * seen / whole.clip(1), label=f"person {objectid}")
panels["d"].axhline(20, color="grey", linestyle=":", label="less than this counts as hidden")
panels["d"].set(xlabel="frame", ylabel="seen of the person [%]", title="What the camera sees of whom")
panels["d"].legend()

Path("pictures").mkdir(exist_ok=True)
figure.savefig("pictures/1_simulate.png", dpi=120)

# %% [markdown]
# To keep a recording: `unocclude.save_recording(recording, "recordings/wall")`. The same from the command line is
# `unocclude simulate wall -o recordings --seed 1`. Next: [2_solve.py](2_solve.py) finds the two people again.
