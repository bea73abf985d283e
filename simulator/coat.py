"""A wide coat: rings round the torso that widen below the hips, and a sleeve round each arm.

Below the hips each half of the coat goes with its thigh, the seams in front and behind with both: so the legs stay
under it as they stride.
"""

import numpy as np
from jaxtyping import Float
from scipy.ndimage import gaussian_filter1d

from simulator.body import SIDES, Body
from simulator.props import Coat
from simulator.skin import Skin, joined, tube_faces

_TORSO = ("pelvis", "lumbar", "thorax", "neck")
_RING_M = 0.04
_SECTIONS = 40
_SLEEVE_SECTIONS = 16
_BAND_M = 0.03
"""A ring's outline is that of the body so far above and below it."""
_NECK_M = 0.065
"""Radius of a neck, which the shoulders' slope ends at."""
_WITH_THIGHS = 0.75
"""How much of the thighs' motion the hem takes."""
_ROUNDNESS = 2.5
"""Exponent of the rings' superellipse; 2 is an ellipse, more is boxier."""


def coat_skin(body: Body, coat: Coat) -> Skin:
    """The coat on the body at rest."""
    return joined([_round_torso(body, coat), *(_sleeve(body, coat, side) for side in SIDES)])


def _round_torso(body: Body, coat: Coat) -> Skin:
    top, hem = float(body.joint("neck")[2]), coat.hem
    heights = np.linspace(top, hem, max(4, round((top - hem) / _RING_M)))
    outline = _outline(body, heights, coat.loose)
    hip = float(body.joint("thigh.L")[2])
    below = np.clip((hip - heights) / max(hip - hem, 1e-6), 0.0, 1.0)
    angle = np.arange(_SECTIONS) * 2 * np.pi / _SECTIONS
    unit = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    unit = np.sign(unit) * np.abs(unit) ** (2 / _ROUNDNESS)
    spread = outline[:, None, 1:] + coat.flare * below[:, None, None]
    places = unit * spread
    places[..., 0] += outline[:, None, 0]
    level = np.broadcast_to(heights[:, None, None], (*places.shape[:2], 1))
    return Skin(
        vertices=np.concatenate([places, level], axis=-1).reshape(-1, 3),
        faces=tube_faces(len(heights), _SECTIONS),
        weights=_torso_weights(body, heights, below, np.sin(angle)),
    )


def _outline(body: Body, heights: Float[np.ndarray, "ring"], loose: float) -> Float[np.ndarray, "ring 3"]:
    """Middle (x), half depth and half width of a loose ring at each height, metres; below the hips as at the hips."""
    hip = float(body.joint("thigh.L")[2])
    arms = [index for index, bone in enumerate(body.bones) if bone.split(".")[0] in ("upper_arm", "forearm", "hand")]
    torso = body.vertices[body.weights[:, arms].sum(axis=1) < 0.5]
    rings = []
    for height in np.maximum(heights, hip):
        band = torso[np.abs(torso[:, 2] - height) < _BAND_M]
        back, front = float(band[:, 0].min()), float(band[:, 0].max())
        rings.append(((back + front) / 2, (front - back) / 2 + loose, float(np.abs(band[:, 1]).max()) + loose))
    outline = gaussian_filter1d(np.array(rings), 1.0, axis=0, mode="nearest")
    shoulder, neck = float(body.joint("upper_arm.L")[2]) + 0.02, body.joint("neck")
    rise = np.clip((heights - shoulder) / (neck[2] - shoulder), 0.0, 1.0)[:, None] ** 1.5
    return outline + rise * (np.array([neck[0], _NECK_M + loose, _NECK_M + loose]) - outline)


def _torso_weights(
    body: Body, heights: Float[np.ndarray, "ring"], below: Float[np.ndarray, "ring"], left: Float[np.ndarray, "section"]
) -> Float[np.ndarray, "vertex bone"]:
    """Each ring moves as the torso does at its height; below the hips the halves go with the thighs."""
    own = [body.bones.index(bone) for bone in _TORSO]
    spine = body.vertices[:, 2]
    weights = np.zeros((len(heights), len(left), len(body.bones)))
    for ring, height in enumerate(heights):
        near = np.abs(spine - height) < _BAND_M
        share = body.weights[near][:, own].sum(axis=0).astype(np.float64)
        weights[ring, :, own] = (share / share.sum())[:, None] if below[ring] == 0 else np.eye(len(own))[0][:, None]
    with_thighs = (_WITH_THIGHS * below**2 * (3 - 2 * below))[:, None]
    leftness = 0.5 + 0.5 * np.clip(1.5 * left, -1.0, 1.0)
    weights *= 1 - with_thighs[..., None]
    weights[..., body.bones.index("thigh.L")] = with_thighs * leftness
    weights[..., body.bones.index("thigh.R")] = with_thighs * (1 - leftness)
    return weights.reshape(-1, len(body.bones))


def _sleeve(body: Body, coat: Coat, side: str) -> Skin:
    """A tube from the shoulder over the elbow to the wrist, closed at the shoulder by the first ring's smallness."""
    shoulder, elbow, wrist = (body.joint(f"{bone}.{side}") for bone in ("upper_arm", "forearm", "hand"))
    inward = shoulder + np.array([0.0, -0.05 * np.sign(shoulder[1]), 0.03])
    arms = [_radius(body, f"{bone}.{side}", ends) for bone, ends in _arm_bones(shoulder, elbow, wrist)]
    upper, lower = (radius + 0.6 * coat.loose for radius in arms)
    along = [inward, shoulder, *np.linspace(shoulder, elbow, 6)[1:-1], elbow, *np.linspace(elbow, wrist, 6)[1:]]
    radii = [0.3 * upper, upper, *np.linspace(upper, (upper + lower) / 2, 6)[1:], *np.full(5, lower)]
    on_forearm = [0.0, 0.0, 0.0, 0.0, 0.0, 0.15, 0.5, 0.85, 1.0, 1.0, 1.0, 1.0]
    centre = np.array(along)
    angle = np.arange(_SLEEVE_SECTIONS) * 2 * np.pi / _SLEEVE_SECTIONS
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)  # Arms hang: rings lie flat.
    places = centre[:, None] + np.array(radii)[:, None, None] * circle
    weights = np.zeros((len(centre), len(angle), len(body.bones)))
    weights[..., body.bones.index(f"upper_arm.{side}")] = 1 - np.array(on_forearm)[:, None]
    weights[..., body.bones.index(f"forearm.{side}")] = np.array(on_forearm)[:, None]
    weights[0] = 0.0
    weights[0, :, body.bones.index(f"shoulder.{side}")] = 1.0
    return Skin(
        vertices=places.reshape(-1, 3),
        faces=tube_faces(len(centre), len(angle)),
        weights=weights.reshape(-1, len(body.bones)),
    )


def _arm_bones(
    shoulder: Float[np.ndarray, "3"], elbow: Float[np.ndarray, "3"], wrist: Float[np.ndarray, "3"]
) -> list[tuple[str, tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]]]:
    return [("upper_arm", (shoulder, elbow)), ("forearm", (elbow, wrist))]


def _radius(body: Body, bone: str, ends: tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]) -> float:
    """How far most of a bone's skin lies from the line between its joints, metres."""
    start, way = ends[0], ends[1] - ends[0]
    own = body.vertices[body.weights[:, body.bones.index(bone)] > 0.7].astype(np.float64)
    share = np.clip((own - start) @ way / (way @ way), 0.0, 1.0)
    return float(np.percentile(np.linalg.norm(own - start - share[:, None] * way, axis=1), 90))
