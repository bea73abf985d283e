# %% [markdown]
# # 6. Training data: recordings as a PyTorch `Dataset`
#
# A simulated recording knows everything about every pixel: depth, object, and where its point goes next, hidden or not.
# That is training data. PyTorch asks of a data set that it has a length and that its items can be asked for by number,
# and nothing more; so the class below needs no PyTorch, and Unocclude does not depend on it.

# %%
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import unocclude

CLIP = 3


class DepthClips:
    """Clips of consecutive frames, with what moves in them; an item is a dictionary of arrays.

    `depth` (frame, row, column): metres, 0 where nothing returned. `objectid` (frame, row, column): 0 for nothing.
    `motion` (row, column, 3): how far the point behind each pixel of the middle frame moves to the next, metres,
    world axes; 0 where there is none.
    """

    def __init__(self, recordings: Sequence[unocclude.Recording]) -> None:
        self._recordings = recordings
        self._starts = [
            (which, start) for which, of in enumerate(recordings) for start in range(len(of.frames) - CLIP + 1)
        ]

    def __len__(self) -> int:
        return len(self._starts)

    def __getitem__(self, index: int) -> dict[str, np.ndarray]:
        which, start = self._starts[index]
        recording = self._recordings[which]
        frames = [recording.frames[number] for number in range(start, start + CLIP)]
        middle = start + CLIP // 2
        return {
            "depth": np.stack([np.nan_to_num(frame.depth) for frame in frames]),
            "objectid": np.stack([frame.labels.objectid for frame in frames]).astype(np.int64),
            "motion": np.nan_to_num(unocclude.flow_between(recording, middle, middle + 1).metres).astype(np.float32),
        }


# %% [markdown]
# Two days of the scene `wall`. From a data set that `unocclude generate` made it is
# `[recording for _, recording in unocclude.recordings_of("data", split="development")]`: frames are read from disk only
# when an item asks for them.

# %%
recordings = [unocclude.simulate("wall", seed=seed, size="128x96", frames=20) for seed in (1, 2)]
clips = DepthClips(recordings)
print(f"{len(clips)} clips of {len(recordings)} recordings")

# %% [markdown]
# PyTorch's `DataLoader` shuffles them, makes batches of tensors, and reads ahead in other processes with
# `num_workers=4`. Where PyTorch is not installed (`pip install torch`), NumPy makes the batch here.

# %%
if find_spec("torch"):
    from torch.utils.data import DataLoader

    batch = next(iter(DataLoader(clips, batch_size=4, shuffle=True)))
else:
    print("PyTorch is not installed: a batch by NumPy")
    chosen = [clips[int(number)] for number in np.random.default_rng(0).permutation(len(clips))[:4]]
    batch = {name: np.stack([clip[name] for clip in chosen]) for name in chosen[0]}
for name, values in batch.items():
    print(f"{name}: {tuple(values.shape)}")

# %% [markdown]
# One item: what a network sees, and what it is to say.

# %%
item = clips[4]
speed = np.linalg.norm(item["motion"], axis=-1) * recordings[0].fps
print(f"fastest point: {speed.max():.1f} m/s")
figure, axes = plt.subplots(1, 3, figsize=(13, 3.4), layout="constrained")
for drawn, title, image in zip(
    axes, ("depth [m]", "object", "speed [m/s]"), (item["depth"][1], item["objectid"][1], speed), strict=True
):
    figure.colorbar(drawn.imshow(np.where(item["objectid"][1] > 0, image, np.nan)), ax=drawn)
    drawn.set_title(title)
    drawn.axis("off")

Path("pictures").mkdir(exist_ok=True)
figure.savefig("pictures/6_torch_dataset.png", dpi=120)

# %% [markdown]
# For code that reads the files of TAPVid-3D, or MOTChallenge text, there is `unocclude export`
# ([docs/exporting.md](../docs/exporting.md)).
