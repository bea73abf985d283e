# %% [markdown]
# # 2. Solve: what moves together, and where it goes while it is hidden
#
# `solve` reads depth, camera and frame rate, nothing else: none of the simulator's truth.

# %%
from pathlib import Path

import matplotlib.pyplot as plt

import unocclude

recording = unocclude.simulate("wall", seed=1)
motions = unocclude.solve(recording)
print(motions)
motions

# %% [markdown]
# A motion is a person, a ball, whatever moves as one. `motions` holds one row a point and frame, as NumPy arrays:
# `frame`, `trajectory`, `position` (metres), `motion`, `confidence`, and `source`: was the point seen, or completed
# while it was hidden, be it behind the wall or on the far side of the body?

# %%
for motion in motions.motion_ids:
    own = motions.rows(motions.motion == motion)
    completed = (~own.observed).mean()
    print(f"motion {motion}: {len(own):,} points, {completed:.0%} of them completed")

# %% [markdown]
# Each motion also has a *representative*, the one curve that stands for it. Where nothing was seen it goes on
# smoothly to where the motion comes out again.

# %%
for curve in motions.representatives:
    hidden = curve.frame[~curve.observed]
    print(f"motion {curve.motion}: out of sight from frame {hidden.min()} to {hidden.max()}")

# %% [markdown]
# Both can be drawn in one call. Through a wall one looks by laying the motions on the depth image: what was
# completed is pale.

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(13, 4.6), layout="constrained")
recording.plot(46, motions=motions, axes=left)
motions.plot(axes=right)

Path("pictures").mkdir(exist_ok=True)
figure.savefig("pictures/2_solve.png", dpi=120)

# %% [markdown]
# Every choice of the solver is a setting with a unit and a meaning; a misspelt one is an error that names the
# nearest. `unocclude.Settings()` are the best that we know, `unocclude.preset_settings("paper")` the paper's.

# %%
unocclude.Settings(longest_hole_seconds=2.0)

# %% [markdown]
# To keep motions: `unocclude.save_motions(motions, "motions.parquet")`, a plain table that pandas, Polars and DuckDB
# read ([docs/motions.md](../docs/motions.md)). From the command line: `unocclude solve recordings/wall`, and to turn
# the scene in 3D `unocclude view recordings/wall`. How it works, step by step: [docs/method.md](../docs/method.md).
# Next: [3_score.py](3_score.py) asks how good this is.
