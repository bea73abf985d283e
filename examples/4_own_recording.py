# %% [markdown]
# # 4. Your own recording: a folder of depth images and a calibration
#
# All that is needed: depth images, the intrinsics of the camera, the frame rate. Here NumPy plays the sensor: two balls
# of 0.6 and 0.7 m pass behind a board, and each frame becomes a 16-bit PNG in millimetres, as most cameras write
# them.

# %%
from pathlib import Path

import cv2
import matplotlib.pyplot as plt
import numpy as np

import unocclude

WIDTH, HEIGHT, FRAMES, FPS = 160, 120, 60, 30
camera = unocclude.Camera(width=WIDTH, height=HEIGHT, fx=140.0, fy=140.0, cx=80.0, cy=60.0)
column, row = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)  # Pixel centres.
rays = np.stack([(column - camera.cx) / camera.fx, (row - camera.cy) / camera.fy, np.ones_like(row)], axis=-1)


def ball(centre: tuple[float, float, float], radius: float) -> np.ndarray:
    """The depth of a ball in every pixel, metres; infinite beside it."""
    along, square = rays @ centre, (rays**2).sum(axis=-1)
    inside = along**2 - square * (np.dot(centre, centre) - radius**2)
    return np.where(inside > 0, (along - np.sqrt(inside.clip(0))) / square, np.inf)


folder = Path("depth")
folder.mkdir(exist_ok=True)
for frame, share in enumerate(np.linspace(0, 1, FRAMES)):
    to_the_right, to_the_left = ball((-1.6 + 3.2 * share, -0.2, 3.5), 0.3), ball((1.7 - 3.4 * share, 0.4, 4.2), 0.35)
    room = np.where(abs(column - WIDTH / 2) < 22, 2.5, 5.0)  # A board before a wall.
    depth = np.minimum(room, np.minimum(to_the_right, to_the_left))
    cv2.imwrite(str(folder / f"{frame:04d}.png"), np.round(1000 * depth).astype(np.uint16))
print(f"{len(list(folder.iterdir()))} images in {folder}/")

# %% [markdown]
# From here on it is as with a real camera. Read the images, turn them into metres (0 or NaN = no return), say which
# camera saw them: that is a recording. Mind `cx` and `cy`: here the centre of the first pixel is at (0.5, 0.5), in most
# calibrations, OpenCV's too, at (0, 0); then add 0.5 to both.

# %%
images = [cv2.imread(str(path), cv2.IMREAD_UNCHANGED) for path in sorted(folder.glob("*.png"))]
depths = [image * 0.001 for image in images]
recording = unocclude.depth_recording(depths, camera=camera, fps=FPS, name="two balls")
print(recording)
recording

# %%
motions = unocclude.solve(recording)
print(motions)
motions

# %% [markdown]
# Nothing says which way is up: the world is the camera's axes, x right, y down, z forward. `motions.plot(camera)` looks
# from the camera's top. There is no truth to score against, but each completed point says how sure it is.

# %%
completed = motions.rows(~motions.observed)
for motion in motions.motion_ids:
    sure = completed.confidence[completed.motion == motion].mean()
    print(f"motion {motion}: {(completed.motion == motion).sum():,} points completed, confidence {sure:.2f} on average")

figure, (left, right) = plt.subplots(1, 2, figsize=(13, 4.6), layout="constrained")
recording.plot(FRAMES // 2, motions=motions, axes=left)
motions.plot(camera, axes=right)

Path("pictures").mkdir(exist_ok=True)
figure.savefig("pictures/4_own_recording.png", dpi=120)

# %% [markdown]
# The command line does it without a line of Python, and takes `cx` and `cy` as calibrations have them:
#
#     unocclude import depth/ --scale 0.001 --fx 140 --fy 140 --cx 79.5 --cy 59.5 --fps 30 -o recordings/mine
#     unocclude solve recordings/mine
#     unocclude view recordings/mine
#
# Next: [5_sweep.py](5_sweep.py) tries settings out.
