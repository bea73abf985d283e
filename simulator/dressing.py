"""Bodies with props: an umbrella, a suitcase or a coat becomes more skin of the body that has it.

So a prop follows its bones by the same linear blend skinning as the body does, needs no pose of its own, and is
one object with its carrier. Body axes as in `simulator.body`: x forward, y to the left, z up.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import trimesh
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from simulator.body import Body
from simulator.coat import coat_skin
from simulator.props import Coat, Prop, Suitcase, Umbrella
from simulator.skin import Skin, joined, tube_faces

Turn = Float[np.ndarray, "3 3"]
_GRIP_M = 0.07
"""From the wrist to the middle of the fist."""
_UMBRELLA_ARM = {"upper_arm": (-0.35, 0.45), "forearm": (-2.1, 0.0)}
"""Forward (negative) and inward, radians: the upper arm a little forward, the forearm up."""
_HEADROOM_M = 0.1
"""Between the top of the head and the rim's height."""
_CASE_ARM_STRAIGHT = 0.2
"""By how much the forearm is turned back from its ease at rest, radians."""
_CASE_HANDLE_M = 0.05
_CASE_GAP_M = 0.02
"""Between a suitcase and the leg beside it."""
_RIBS = 8
_BETWEEN_RIBS = 4
_SHAFT_RADIUS_M = 0.012


def dressed(body: Body, props: Sequence[Prop]) -> Body:
    """The body with the props as more skin; its own vertices and faces keep their numbers."""
    bare = Skin(vertices=body.vertices, faces=body.faces, weights=body.weights)
    skin = joined([bare, *(_skin(body, prop) for prop in props)])
    return replace(
        body,
        vertices=skin.vertices.astype(np.float32),
        faces=skin.faces.astype(np.int32),
        weights=skin.weights.astype(np.float32),
    )


def holding(body: Body, props: Iterable[Prop]) -> dict[str, Turn]:
    """The local rotations of the bones of arms that hold something: these do not swing."""
    turns: dict[str, Turn] = {}
    for prop in props:
        if not isinstance(prop, Coat):
            turns |= _arm(body, prop).turns
    return turns


@dataclass(frozen=True, kw_only=True, eq=False)
class _Arm:
    """An arm that holds something, on a body that otherwise stands at rest."""

    side: str
    turns: dict[str, Turn]
    """Local rotations of its bones."""
    hand_turn: Turn
    """Of the hand against the body."""
    grip: Float[np.ndarray, "3"]
    """The middle of the fist, body axes, metres."""


def _skin(body: Body, prop: Prop) -> Skin:
    if isinstance(prop, Coat):
        return coat_skin(body, prop)
    arm = _arm(body, prop)
    solids = _umbrella(body, prop, arm.grip) if isinstance(prop, Umbrella) else _suitcase(prop, arm.grip)
    return joined([_in_hand(body, arm, solid) for solid in solids])


def _arm(body: Body, prop: Umbrella | Suitcase) -> _Arm:
    """How the arm is held, and where its fist is then."""
    side = prop.side[0].upper()
    outward = 1.0 if side == "L" else -1.0
    if isinstance(prop, Umbrella):
        angles = {bone: (0.0, forward, -outward * inward) for bone, (forward, inward) in _UMBRELLA_ARM.items()}
    else:
        aside = _case_angle(body, prop, side)
        angles = {"upper_arm": (outward * aside, 0.0, 0.0), "forearm": (0.0, _CASE_ARM_STRAIGHT, 0.0)}
    turns = {bone: Rotation.from_euler("xyz", about).as_matrix() for bone, about in angles.items()}
    shoulder, elbow, wrist = (body.joint(f"{bone}.{side}") for bone in ("upper_arm", "forearm", "hand"))
    hand_turn = turns["upper_arm"] @ turns["forearm"]
    fist = wrist + _GRIP_M * (wrist - elbow) / np.linalg.norm(wrist - elbow)
    grip = shoulder + turns["upper_arm"] @ (elbow - shoulder) + hand_turn @ (fist - elbow)
    return _Arm(
        side=side, turns={f"{bone}.{side}": turn for bone, turn in turns.items()}, hand_turn=hand_turn, grip=grip
    )


def _case_angle(body: Body, case: Suitcase, side: str) -> float:
    """By how much the arm is held away from the body so that the case hangs beside the leg, radians."""
    shoulder, wrist = body.joint(f"upper_arm.{side}"), body.joint(f"hand.{side}")
    own = [body.bones.index(f"{bone}.{side}") for bone in ("thigh", "shin")]
    top = float(wrist[2]) - _GRIP_M
    leg = body.vertices[(body.weights[:, own].sum(axis=1) > 0.5) & (body.vertices[:, 2] < top)]
    wanted = float(np.abs(leg[:, 1]).max()) + _CASE_GAP_M + case.size[1] / 2
    reach = float(np.linalg.norm(wrist - shoulder)) + _GRIP_M
    now = float(np.arctan2(abs(wrist[1] - shoulder[1]), shoulder[2] - wrist[2]))
    return max(0.0, float(np.arcsin(np.clip((wanted - abs(shoulder[1])) / reach, 0.0, 0.7))) - now)


def _in_hand(body: Body, arm: _Arm, solid: trimesh.Trimesh) -> Skin:
    """The solid, given as it is when the arm is held, as skin of the hand of a body at rest."""
    wrist, elbow = body.joint(f"hand.{arm.side}"), body.joint(f"forearm.{arm.side}")
    fist = wrist + _GRIP_M * (wrist - elbow) / np.linalg.norm(wrist - elbow)
    weights = np.zeros((len(solid.vertices), len(body.bones)))
    weights[:, body.bones.index(f"hand.{arm.side}")] = 1.0
    return Skin(
        vertices=(solid.vertices - arm.grip) @ arm.hand_turn + fist,  # The inverse turn, on rows.
        faces=np.array(solid.faces),
        weights=weights,
    )


def _umbrella(body: Body, prop: Umbrella, grip: Float[np.ndarray, "3"]) -> list[trimesh.Trimesh]:
    """The umbrella on its shaft through the fist, tilted so that it covers the head."""
    head = body.joint("head")
    top = np.array([0.0, 0.0, body.height + _HEADROOM_M + prop.depth])
    top[:2] = head[:2] + 0.6 * (grip - head)[:2]
    shaft = (top - grip) / np.linalg.norm(top - grip)
    tilt, _ = Rotation.align_vectors(shaft[None], np.array([[0.0, 0.0, 1.0]]))
    canopy = _canopy(prop)
    canopy.vertices = tilt.apply(canopy.vertices - np.array([0.0, 0.0, prop.depth])) + top
    below, above = grip - 0.1 * shaft, top + 0.05 * shaft
    stick = trimesh.creation.cylinder(radius=_SHAFT_RADIUS_M, segment=np.stack([below, above]), sections=8)
    return [canopy, stick]


def _canopy(prop: Umbrella) -> trimesh.Trimesh:
    """The cloth: a dome from the rim at z = 0 up, drawn in between its ribs."""
    share = np.linspace(0.0, 1.0, 8)[1:]
    angle = np.arange(_RIBS * _BETWEEN_RIBS) * 2 * np.pi / (_RIBS * _BETWEEN_RIBS)
    slack = 0.06 * (1 - np.abs(np.cos(angle * _RIBS / 2)))
    radius = prop.radius * share[:, None] * (1 - slack * share[:, None] ** 2)
    height = np.broadcast_to(prop.depth * (1 - share[:, None] ** 2), radius.shape)
    rings = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=-1)
    vertices = np.concatenate([[[0.0, 0.0, prop.depth]], rings.reshape(-1, 3)])
    sections = len(angle)
    fan = np.stack([np.zeros(sections, int), 1 + np.arange(sections), 1 + (np.arange(sections) + 1) % sections], axis=1)
    return trimesh.Trimesh(vertices, np.concatenate([fan, 1 + tube_faces(len(share), sections)]), process=False)


def _suitcase(prop: Suitcase, grip: Float[np.ndarray, "3"]) -> list[trimesh.Trimesh]:
    """The case below its handle, upright."""
    along, across, up = prop.size
    case = trimesh.creation.box(extents=(along, across, up))
    case.apply_translation(grip - np.array([0.0, 0.0, _CASE_HANDLE_M + up / 2]))
    thick, half = 0.02, min(0.07, 0.4 * along)
    bar = trimesh.creation.box(extents=(2 * half, thick, thick))
    bar.apply_translation(grip)
    posts = [trimesh.creation.box(extents=(thick, thick, _CASE_HANDLE_M)) for _ in range(2)]
    for post, way in zip(posts, (-half, half), strict=True):
        post.apply_translation(grip + np.array([way, 0.0, -_CASE_HANDLE_M / 2]))
    return [case, bar, *posts]
