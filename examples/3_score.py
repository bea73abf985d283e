# %% [markdown]
# # 3. Score: how good are the motions?
#
# Whoever simulates knows the truth, hidden frames included. `evaluate` holds motions against it.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import unocclude

recording = unocclude.simulate("wall", seed=1)
motions = unocclude.solve(recording)
scores = unocclude.evaluate(recording, motions)
scores

# %% [markdown]
# Scores are a dictionary, the same as `unocclude evaluate --json` prints. What cannot be computed is `None`, never 0
# or 1. Purity alone is worth nothing (one motion a point would have 1), hence always with its inverse; an error in
# hidden frames is worth nothing without the share of hidden frames that has an answer at all (`recall`).

# %%
print(f"found: {scores['motions']['found']} of {scores['objects']} people")
print(f"purity {scores['motions']['purity']:.2f}, inverse purity {scores['motions']['inverse_purity']:.2f}")
print(f"identity: IDF1 {scores['identity']['idf1']:.2f}, HOTA {scores['identity']['hota']:.2f}")
hidden = scores["completion"]
print(f"hidden: recall {hidden['recall']:.2f}, the centre {100 * hidden['centre_mean_m']:.0f} cm off on average")

# %% [markdown]
# Beside the numbers, the ways: found ones in colour over the true ones in grey, from above. The truth is the centre
# of each person's whole front side, in every frame.

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(13, 4.2), layout="constrained")
scores.plot(axes=left)
x, y, _ = np.moveaxis(unocclude.visibility_of(recording).centre, -1, 0)
right.plot(x.T, y.T, color="silver", linewidth=8, zorder=0, label=["truth", "_"])  # "_" stays out of the legend.
motions.plot(axes=right)

Path("pictures").mkdir(exist_ok=True)
figure.savefig("pictures/3_score.png", dpi=120)

# %% [markdown]
# `unocclude evaluate recordings/wall` prints the same, `unocclude report recordings/wall -o wall.html` makes a page
# with every hole and the failures first, `unocclude compare` has baselines and your own method in one table
# ([docs/benchmark.md](../docs/benchmark.md)). Next: [4_own_recording.py](4_own_recording.py), without any truth.
