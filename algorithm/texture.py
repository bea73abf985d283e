"""What of a photograph stays constant when the light changes: its texture."""

import numpy as np
from jaxtyping import Float32

_THETA = 1 / 8
_ITERATIONS = 100
_TAKEN_OFF = 0.95
"""The share of the structure that is taken off, so that a little of it still guides where there is no texture."""


def textures(images: Float32[np.ndarray, "image row column"]) -> Float32[np.ndarray, "image row column"]:
    """The images less 95 % of their structure, all on one scale from 0 to 255; all zero where nothing differs.

    The structure is the smooth part that the model of Rudin, Osher and Fatemi finds; what is left keeps still
    when shadows move [Wedel et al., "An improved algorithm for TV-L1 optical flow", 2009].
    """
    scaled = _stretched(images, low=-1.0, high=1.0)
    return _stretched(np.stack([image - _TAKEN_OFF * structure(image) for image in scaled]), low=0.0, high=255.0)


def structure(image: Float32[np.ndarray, "row column"]) -> Float32[np.ndarray, "row column"]:
    """The image u near f that minimises the total variation of u plus (u - f)^2 / (2 theta).

    By projected gradient steps on the dual [Chambolle, 2004], started at zero.
    """
    along, down = np.zeros_like(image), np.zeros_like(image)  # The last column and the last row stay zero.
    for _ in range(_ITERATIONS):
        smooth = image + _THETA * _divergence(along, down)
        along[:, :-1] += np.diff(smooth, axis=1) / (4 * _THETA)
        down[:-1] += np.diff(smooth, axis=0) / (4 * _THETA)
        length = np.maximum(1, np.sqrt(along**2 + down**2))
        along /= length
        down /= length
    return image + _THETA * _divergence(along, down)


def _divergence(along: np.ndarray, down: np.ndarray) -> np.ndarray:
    divergence = along + down
    divergence[:, 1:] -= along[:, :-1]
    divergence[1:] -= down[:-1]
    return divergence


def _stretched(images: np.ndarray, *, low: float, high: float) -> np.ndarray:
    darkest, brightest = float(images.min()), float(images.max())
    scale = (high - low) / (brightest - darkest) if brightest > darkest else 0.0
    return (low + (images - darkest) * scale).astype(np.float32)
