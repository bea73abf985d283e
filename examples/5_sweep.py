# %% [markdown]
# # 5. Sweep: what does a setting do?
#
# How long a hole may be before we no longer believe that it is the same person: `longest_hole_seconds`. The solver
# works in stages (flow, trajectories, segments, motions), and this setting belongs to the last of them. With a
# `Cache` the others are made once, so each further value costs a fraction of the first.

# %%
from pathlib import Path

import matplotlib.pyplot as plt

import unocclude

recording = unocclude.simulate("wall", seed=1)
cache = unocclude.Cache(folder=Path("cache"))
recall = {}
for seconds in (0.25, 0.5, 0.75, 1.0):
    settings = unocclude.Settings(longest_hole_seconds=seconds)
    motions = unocclude.solve(recording, settings, cache=cache)
    scores = unocclude.evaluate(recording, motions)
    recall[seconds] = scores["completion"]["recall"]
    print(f"{seconds:.2f} s: {scores['motions']['found']} of {scores['objects']} found, recall {recall[seconds]:.2f}")

# %% [markdown]
# The scores jump where the setting passes the longest time for which nothing of a person was seen. The last
# motions went through every hole, so they know how long that was.

# %%
unseen = max((~curve.observed).sum() for curve in motions.representatives) / recording.fps
print(f"the longest hole lasts {unseen:.2f} s")

figure, axes = plt.subplots(figsize=(6.4, 4), layout="constrained")
axes.plot(list(recall), list(recall.values()), "o-")
axes.axvline(unseen, color="grey", linestyle=":")
axes.text(unseen + 0.02, 0.5, "the longest time\nthat nothing was seen", color="grey", va="center")
axes.set(xlabel="longest_hole_seconds [s]", ylabel="hidden frames that are completed (recall)", ylim=(0, 1.05))
axes.set_title("Too little patience loses who is hidden")

Path("pictures").mkdir(exist_ok=True)
figure.savefig("pictures/5_sweep.png", dpi=120)

# %% [markdown]
# For more than a handful of points there is `unocclude sweep`: a TOML file says which settings on which recordings and
# seeds; it uses every core or a cluster, goes on where it was killed, and ends with a table, plots, and the effect
# of each setting with its interval over the seeds ([docs/sweeps.md](../docs/sweeps.md)):
#
#     name = "patience"
#     scenes = ["wall", "forest"]
#     seeds = [1, 2, 3]
#     design = "grid"
#
#     [axes]
#     longest_hole_seconds = [0.25, 0.5, 0.75, 1.0]
#
# Next: [6_torch_dataset.py](6_torch_dataset.py) turns recordings into training data.
