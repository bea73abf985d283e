"""Captured motions on our bodies: every bone points where the captured person's bone points.

A BVH skeleton has other proportions, another pose at rest (arms spread instead of hanging) and other axes (y up, facing
z) than a body here. So per bone: the least rotation that takes our bone at rest to theirs at rest, then theirs in the
frame. The bone's roll about its own direction follows theirs. Lengths are scaled by the ratio of the legs' lengths, so
the file's unit does not matter.
"""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation, Slerp

from recording.checks import nearest_name
from recording.errors import InputError
from recording.truth import MeshSequence
from simulator.body import SIDES, Body, load_body, posed
from simulator.bvh import Clip
from simulator.limb import turns
from simulator.motion_file import Motion, clip_of

_OURS_FROM_BVH = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Axes: y up and z forward become z up and x forward; left is x there, y here."""
_LIMBS = {
    "thigh": ("UpLeg", "Leg"),
    "shin": ("Leg", "Foot"),
    "upper_arm": ("Arm", "ForeArm"),
    "forearm": ("ForeArm", "Hand"),
}
"""Our bone: the captured joints between which theirs is, without the side."""
_BACK = {"lumbar": ("LowerBack", "Spine1"), "thorax": ("Spine1", "Neck"), "neck": ("Neck", "Head")}
_NEXT = {"thigh": "shin", "shin": "foot", "upper_arm": "forearm", "forearm": "hand"}
_NEXT_BACK = {"lumbar": "thorax", "thorax": "neck", "neck": "head"}
_SIDE_NAMES = dict(zip(SIDES, ("Left", "Right"), strict=True))
_STANDING_PERCENTILE = 5.0
"""Of the lowest points of all moments: what is on the ground. More would sink in, less would trust one bad frame."""
_STANDING_MOMENTS = 300
"""At the most so many moments of the clip are looked at to find the ground."""

Rotations = Float[np.ndarray, "frame 3 3"]


def performing_person(
    body: Body,
    motion: Motion,
    times: Float[np.ndarray, "frame"],
    *,
    holding: Mapping[str, Float[np.ndarray, "3 3"]] | None = None,
) -> MeshSequence:
    """The body in each frame as it performs the motion; world axes, metres, the ground at z = 0.

    The clip as a whole is set on the ground: no frame is moved by itself, so a jump stays one. After the clip's end
    its last pose stays. `holding` are local rotations of bones that keep still (`simulator.dressing`).
    """
    clip = clip_of(motion)
    still = {bone: np.broadcast_to(turn, (len(times), 3, 3)) for bone, turn in (holding or {}).items()}
    rotations, root = _pose(body, clip, motion.start_s + times)
    yaw, shift = _placing(body, clip, motion)
    rotations["pelvis"] = yaw @ rotations["pelvis"]
    root = root @ yaw.T + shift - np.array([0.0, 0.0, _ground(load_body(body.name), clip)])  # Bare: no prop stands.
    return MeshSequence(faces=body.faces, vertices=posed(body, rotations | still, root))


def ground_track(body: Body, motion: Motion, times: Float[np.ndarray, "frame"]) -> Float[np.ndarray, "frame 2"]:
    """Where on the ground the pelvis is in each frame, metres."""
    clip = clip_of(motion)
    yaw, shift = _placing(body, clip, motion)
    return np.asarray((_root(body, clip, motion.start_s + times) @ yaw.T + shift)[:, :2])


def _placing(body: Body, clip: Clip, motion: Motion) -> tuple[Float[np.ndarray, "3 3"], Float[np.ndarray, "3"]]:
    """The turn about the vertical, then the shift, that bring the clip to its place on the scene."""
    begin = np.array([motion.start_s])
    pelvis = _turned(clip, "Hips", begin)[0]
    angle = np.radians(motion.heading_deg) - np.arctan2(pelvis[1, 0], pelvis[0, 0])
    yaw = Rotation.from_euler("z", angle).as_matrix()
    place = yaw @ _root(body, clip, begin)[0]
    return yaw, np.array([motion.position[0] - place[0], motion.position[1] - place[1], 0.0])


def _ground(body: Body, clip: Clip) -> float:
    """The height on which the body stands in the clip as it comes, metres."""
    end = (len(clip.root) - 1) * clip.frame_time
    times = np.linspace(0.0, end, min(len(clip.root), _STANDING_MOMENTS))
    lowest = posed(body, *_pose(body, clip, times))[..., 2].min(axis=1)
    return float(np.percentile(lowest, _STANDING_PERCENTILE))


def _pose(body: Body, clip: Clip, times: Float[np.ndarray, "frame"]) -> tuple[dict[str, Rotations], np.ndarray]:
    """Every bone's local rotation, and the root's place, at times of the clip; our axes, metres."""
    joint_of = {"pelvis": "Hips", "head": "Head"} | {bone: joints[0] for bone, joints in _BACK.items()}
    for side, name in _SIDE_NAMES.items():
        joint_of |= {f"{bone}.{side}": name + joints[0] for bone, joints in _LIMBS.items()}
        joint_of |= {f"foot.{side}": f"{name}Foot", f"toes.{side}": f"{name}ToeBase", f"hand.{side}": f"{name}Hand"}
    at_rest = _rest_turns(body, clip)
    world: dict[str, Rotations] = {}
    local: dict[str, Rotations] = {}
    for bone, parent in zip(body.bones, body.parents.tolist(), strict=True):
        above = world[body.bones[parent]] if parent >= 0 else np.tile(np.eye(3), (len(times), 1, 1))
        joint = joint_of.get(bone)
        if joint is None or joint not in clip.joints:
            world[bone] = above  # Keeps its place on its parent.
            continue
        world[bone] = _turned(clip, joint, times) @ at_rest.get(bone, np.eye(3))
        local[bone] = np.swapaxes(above, 1, 2) @ world[bone]
    return local, _root(body, clip, times)


def _rest_turns(body: Body, clip: Clip) -> dict[str, Float[np.ndarray, "3 3"]]:
    """The rotations that take our bones at rest to the captured skeleton's at rest; the pelvis and the head have none.

    Hands go with the forearms. A sole is flat on the ground at rest in both: a foot turns only so that the ankle is
    at right angles as theirs, its toes towards theirs.
    """
    found = {}
    for bone, (first, last) in _BACK.items():
        if first in clip.joints and last in clip.joints:
            found[bone] = _least(_ours(body, bone, _NEXT_BACK[bone]), _theirs(clip, first, last))
    for side, name in _SIDE_NAMES.items():
        for bone, (first, last) in _LIMBS.items():
            ours = _ours(body, f"{bone}.{side}", f"{_NEXT[bone]}.{side}")
            found[f"{bone}.{side}"] = _least(ours, _theirs(clip, name + first, name + last))
        found[f"hand.{side}"] = found[f"forearm.{side}"]
        foot, shin = f"{name}Foot", _theirs(clip, f"{name}Leg", f"{name}Foot")
        toes = _theirs(clip, foot, f"{name}ToeBase") if f"{name}ToeBase" in clip.joints else np.array([1.0, 0.0, 0.0])
        down, forward = np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])
        if np.linalg.norm(np.cross(shin, toes)) < 0.1 * np.linalg.norm(shin) * np.linalg.norm(toes):
            toes = forward  # Toes that hang in line with the shin say nothing.
        found[f"foot.{side}"] = found[f"toes.{side}"] = turns((down, forward), (shin[None], toes[None]))[0]
    return found


def _turned(clip: Clip, joint: str, times: Float[np.ndarray, "frame"]) -> Rotations:
    """The joint's rotation against the world at times of the clip, our axes."""
    number = _number(clip, joint)
    known = np.arange(len(clip.root)) * clip.frame_time
    turn = np.tile(np.eye(3), (len(times), 1, 1))
    while number >= 0:
        own = clip.rotations[number]
        at_times = Slerp(known, own)(np.clip(times, 0.0, known[-1])) if len(known) > 1 else own[[0] * len(times)]
        turn = at_times.as_matrix() @ turn
        number = clip.parents[number]
    return np.asarray(_OURS_FROM_BVH @ turn @ _OURS_FROM_BVH.T)


def _root(body: Body, clip: Clip, times: Float[np.ndarray, "frame"]) -> Float[np.ndarray, "frame 3"]:
    """The root's place at times of the clip, our axes, metres."""
    known = np.arange(len(clip.root)) * clip.frame_time
    places = np.stack([np.interp(times, known, axis) for axis in clip.root.T], axis=-1)
    return np.asarray(places @ _OURS_FROM_BVH.T * (_our_leg(body) / _their_leg(clip)))


def _our_leg(body: Body) -> float:
    return sum(float(np.linalg.norm(_ours(body, f"{bone}.L", f"{_NEXT[bone]}.L"))) for bone in ("thigh", "shin"))


def _their_leg(clip: Clip) -> float:
    return sum(
        float(np.linalg.norm(_theirs(clip, f"Left{a}", f"Left{b}"))) for a, b in (("UpLeg", "Leg"), ("Leg", "Foot"))
    )


def _ours(body: Body, bone: str, after: str) -> Float[np.ndarray, "3"]:
    """From a bone's joint to the next one's, at rest, metres."""
    return body.joint(after) - body.joint(bone)


def _theirs(clip: Clip, joint: str, after: str) -> Float[np.ndarray, "3"]:
    """From a captured joint to another, at rest, our axes, the file's unit."""
    along = _OURS_FROM_BVH @ (clip.rest[_number(clip, after)] - clip.rest[_number(clip, joint)])
    if not along.any():
        raise InputError(f"motion: expected the joints {joint!r} and {after!r} apart at rest, got both at one place")
    return np.asarray(along)


def _number(clip: Clip, joint: str) -> int:
    if joint not in clip.joints:
        raise InputError(
            f"motion: expected a joint {joint!r} as in the CMU skeleton, {nearest_name(joint, clip.joints)}"
        )
    return clip.joints.index(joint)


def _least(ours: Float[np.ndarray, "3"], theirs: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """The least rotation that takes the one direction to the other; about the forward axis where they are opposite."""
    a, b = ours / np.linalg.norm(ours), theirs / np.linalg.norm(theirs)
    axis, cosine = np.cross(a, b), float(a @ b)
    sine = float(np.linalg.norm(axis))
    if sine < 1e-9:
        return np.eye(3) if cosine > 0 else np.diag([1.0, -1.0, -1.0])
    return np.asarray(Rotation.from_rotvec(axis / sine * np.arctan2(sine, cosine)).as_matrix())
