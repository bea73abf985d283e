"""A human body: a mesh at rest, a skeleton, and the pose that a set of joint rotations gives it.

Body axes: x forward, y to the left, z up, the ground at z = 0, metres. At rest a body stands upright, its
arms hanging; every bone's axes at rest are the body's axes, so a rotation means the same for all of them.
"""

import difflib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import as_file, files

import numpy as np
from jaxtyping import Float, Float32, Int32

from recording.errors import InputError

ASSETS = files("scenes") / "assets"
SIDES = ("L", "R")
"""Left and right, in the order of every axis called `side`; the suffix of bone names."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Body:
    """A body at rest: skin, skeleton, and how the one follows the other."""

    name: str
    """Which body this is: `man`, `woman`, `heavy`, `teen`."""
    vertices: Float32[np.ndarray, "vertex 3"]
    """The skin at rest, body axes, metres."""
    faces: Int32[np.ndarray, "face 3"]
    """Vertex numbers of each face's corners, counter-clockwise from outside."""
    bones: tuple[str, ...]
    """Bone names, parents before children."""
    parents: Int32[np.ndarray, "bone"]
    """Number of each bone's parent; -1 for the first bone, the root."""
    joints: Float32[np.ndarray, "bone 3"]
    """The joint that each bone turns about, at rest, body axes, metres."""
    weights: Float32[np.ndarray, "vertex bone"]
    """How much of each bone's motion each vertex takes; every row sums to one."""

    @property
    def height(self) -> float:
        """Stature at rest, metres."""
        return float(np.ptp(self.vertices[:, 2]))

    def joint(self, bone: str) -> Float[np.ndarray, "3"]:
        """The joint that a bone turns about, at rest, body axes, metres."""
        return self.joints[self.bones.index(bone)].astype(np.float64)


def body_names() -> list[str]:
    """The bodies that there are, in alphabetical order."""
    stems = (asset.name.removesuffix(".npz") for asset in ASSETS.iterdir() if asset.name.endswith(".npz"))
    return sorted(stem.removeprefix("body_") for stem in stems)


def load_body(name: str) -> Body:
    """The body of that name, read from the scenes' assets."""
    known = body_names()
    if name not in known:
        nearest = difflib.get_close_matches(name, known, n=1, cutoff=0)[0]
        raise InputError(f"Expected a body ({', '.join(known)}), got '{name}': did you mean '{nearest}'?")
    with as_file(ASSETS / f"body_{name}.npz") as file, np.load(file, allow_pickle=False) as stored:
        weights = np.zeros((len(stored["vertices"]), len(stored["bones"])), np.float32)
        np.put_along_axis(weights, stored["weight_bones"].astype(np.intp), stored["weights"], axis=1)
        return Body(
            name=name,
            vertices=stored["vertices"],
            faces=stored["faces"].astype(np.int32),
            bones=tuple(str(bone) for bone in stored["bones"]),
            parents=stored["parents"].astype(np.int32),
            joints=stored["joints"],
            weights=weights / weights.sum(axis=1, keepdims=True),
        )


def posed(
    body: Body,
    local_rotations: Mapping[str, Float[np.ndarray, "frame 3 3"]],
    root_position: Float[np.ndarray, "frame 3"],
) -> Float32[np.ndarray, "frame vertex 3"]:
    """The skin in every frame, world axes, metres, by linear blend skinning.

    `local_rotations` turn a bone against its parent, the root against the world; a bone without one
    keeps its place on its parent. `root_position` is where the root's joint goes.

    Each vertex is the weighted mean of where its bones would carry it. Written out, that is one product
    of a matrix that depends on the body alone with the bones' transforms, so all frames take one call.
    """
    rotations, positions = bone_transforms(body, local_rotations, root_position)
    frames, bones = positions.shape[:2]
    shifts = positions - np.einsum("fbij,bj->fbi", rotations, body.joints)
    transforms = np.concatenate([np.swapaxes(rotations, -1, -2), shifts[:, :, None]], axis=2)
    skin = np.pad(body.vertices, ((0, 0), (0, 1)), constant_values=1.0)
    carried = (body.weights[:, :, None] * skin[:, None, :]).reshape(len(skin), bones * 4)
    return carried @ transforms.reshape(frames, bones * 4, 3).astype(np.float32)


def bone_transforms(
    body: Body,
    local_rotations: Mapping[str, Float[np.ndarray, "frame 3 3"]],
    root_position: Float[np.ndarray, "frame 3"],
) -> tuple[Float[np.ndarray, "frame bone 3 3"], Float[np.ndarray, "frame bone 3"]]:
    """Every bone's rotation and its joint's place, world axes, by walking down the skeleton."""
    frames = len(root_position)
    rotations = np.empty((frames, len(body.bones), 3, 3))
    positions = np.empty((frames, len(body.bones), 3))
    for bone, (name, parent) in enumerate(zip(body.bones, body.parents.tolist(), strict=True)):
        local = local_rotations.get(name, np.eye(3))
        if parent < 0:
            rotations[:, bone], positions[:, bone] = local, root_position
        else:
            rotations[:, bone] = rotations[:, parent] @ local
            reach = (body.joints[bone] - body.joints[parent]).astype(np.float64)
            positions[:, bone] = positions[:, parent] + rotations[:, parent] @ reach
    return rotations, positions
