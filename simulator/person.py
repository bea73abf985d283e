"""Somebody who walks: a body that follows a planned walk with planted feet."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import gaussian_filter1d, minimum_filter1d

from recording.truth import MeshSequence
from simulator.body import SIDES, Body, posed
from simulator.gait import RATE, Step, Walk, planned_steps, planned_walk
from simulator.path import Path

Rotations = Float[np.ndarray, "moment 3 3"]
_LONGEST_REACH = 0.995
"""Of a leg's length; a knee is never quite straight."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Walker:
    """A person in every frame."""

    mesh: MeshSequence
    stance: Bool[np.ndarray, "frame side"]
    """Whether the left and the right foot are down."""


def walking_person(
    body: Body,
    path: Path,
    times: Float[np.ndarray, "frame"],
    *,
    phase: float,
    holding: Mapping[str, Float[np.ndarray, "3 3"]] | None = None,
) -> Walker:
    """The body walking along the path, in each frame; `phase` is that of the gait, in cycles, in the first.

    World axes, metres, the ground at z = 0. `holding` are local rotations of bones that keep still, as those of
    an arm that holds something do (`simulator.dressing`).
    """
    hip = body.joint("thigh.L")
    walk = planned_walk(path, thigh_height=float(hip[2]), phase=phase, begin=float(times[0]), end=float(times[-1]))
    steps = [planned_steps(walk, side=side, half_width=0.75 * float(hip[1])) for side in (0, 1)]
    ankles = [_ankle(body, step, SIDES[side]) for side, step in enumerate(steps)]
    swing = np.cos(2 * np.pi * walk.phase) * np.clip(walk.speed / 1.4, 0.0, 1.2)
    pelvis_turn = _about_z(walk.heading - 0.08 * swing)
    root = _pelvis(body, walk, pelvis_turn, ankles)
    rotations = {"pelvis": pelvis_turn} | _torso_and_arms(swing)
    rotations |= {bone: np.broadcast_to(turn, pelvis_turn.shape) for bone, turn in (holding or {}).items()}
    for side, name in enumerate(SIDES):
        rotations |= _leg(body, name, (pelvis_turn, root), (ankles[side], steps[side]))
    chosen = np.clip(np.round((times - walk.time[0]) * RATE).astype(int), 0, len(walk.time) - 1)
    vertices = posed(body, {bone: turn[chosen] for bone, turn in rotations.items()}, root[chosen])
    return Walker(
        mesh=MeshSequence(faces=body.faces, vertices=vertices),
        stance=np.stack([step.stance[chosen] for step in steps], axis=1),
    )


def _pelvis(
    body: Body, walk: Walk, turn: Rotations, ankles: list[Float[np.ndarray, "moment 3"]]
) -> Float[np.ndarray, "moment 3"]:
    """The root joint: above the path, as high as at rest or as both legs let it be."""
    rest = body.joint("pelvis")
    height = np.full(len(walk.time), rest[2])
    for side, ankle in zip(SIDES, ankles, strict=True):
        hip = turn @ (body.joint(f"thigh.{side}") - rest)
        reach = _LONGEST_REACH * sum(_leg_lengths(body, side))
        apart = np.linalg.norm(ankle[:, :2] - walk.place - hip[:, :2], axis=1)
        room = np.sqrt(np.maximum(reach**2 - apart**2, 0.25 * reach**2))
        height = np.minimum(height, ankle[:, 2] + room - hip[:, 2])
    height = gaussian_filter1d(minimum_filter1d(height, 9, mode="nearest"), 5, mode="nearest")
    return np.concatenate([walk.place, height[:, None]], axis=1)


def _ankle(body: Body, step: Step, side: str) -> Float[np.ndarray, "moment 3"]:
    """Where the ankle of a foot is that rolls over its ball or its heel."""
    ankle, ball = body.joint(f"foot.{side}"), body.joint(f"toes.{side}")
    foot = body.vertices[body.weights[:, body.bones.index(f"foot.{side}")] > 0.5]
    heel = np.array([foot[:, 0].min() + 0.02, ankle[1], 0.0])
    turn = _about_y(step.pitch)
    flat = np.array([0.0, 0.0, ankle[2]])
    over_ball = ball - ankle + turn @ (ankle - ball)
    over_heel = heel - ankle + turn @ (ankle - heel)
    moved = flat + np.where(step.pitch[:, None] > 0, over_ball, over_heel)
    world = np.einsum("mij,mj->mi", _about_z(step.yaw), moved)
    return world + np.concatenate([step.ground, step.lift[:, None]], axis=1)


def _leg(
    body: Body, side: str, pelvis: tuple[Rotations, np.ndarray], foot: tuple[np.ndarray, Step]
) -> dict[str, Rotations]:
    """The local rotations of thigh, shin, foot and toes that bring the ankle to its place."""
    (turn, root), (ankle, step) = pelvis, foot
    rest = {bone: body.joint(f"{bone}.{side}") for bone in ("thigh", "shin", "foot")}
    hip = root + turn @ (rest["thigh"] - body.joint("pelvis"))
    thigh, shin = _leg_lengths(body, side)
    reach = ankle - hip
    distance = np.clip(np.linalg.norm(reach, axis=1), 0.3 * (thigh + shin), 0.9995 * (thigh + shin))
    down = reach / np.linalg.norm(reach, axis=1, keepdims=True)
    left = turn[:, :, 1] - np.einsum("mi,mi->m", turn[:, :, 1], down)[:, None] * down
    left /= np.linalg.norm(left, axis=1, keepdims=True)
    bend = np.arccos(np.clip((thigh**2 + distance**2 - shin**2) / (2 * thigh * distance), -1.0, 1.0))
    along_thigh = _turned_about(left, -bend, down)
    knee = hip + thigh * along_thigh
    along_shin = hip + distance[:, None] * down - knee
    along_shin /= np.linalg.norm(along_shin, axis=1, keepdims=True)
    thigh_turn = _between(rest["shin"] - rest["thigh"], along_thigh, left)
    shin_turn = _between(rest["foot"] - rest["shin"], along_shin, left)
    flat = _about_z(step.yaw)
    foot_turn = flat @ _about_y(step.pitch)
    toes = np.where((step.pitch > 0)[:, None, None], flat, foot_turn)
    return {
        f"thigh.{side}": np.swapaxes(turn, 1, 2) @ thigh_turn,
        f"shin.{side}": np.swapaxes(thigh_turn, 1, 2) @ shin_turn,
        f"foot.{side}": np.swapaxes(shin_turn, 1, 2) @ foot_turn,
        f"toes.{side}": np.swapaxes(foot_turn, 1, 2) @ toes,
    }


def _torso_and_arms(swing: Float[np.ndarray, "moment"]) -> dict[str, Rotations]:
    """The shoulders turn against the hips, and each arm swings against its leg."""
    rotations = {"lumbar": _about_z(0.06 * swing), "thorax": _about_z(0.10 * swing), "head": _about_z(-0.07 * swing)}
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        back = sign * swing
        rotations[f"upper_arm.{side}"] = _about_y(0.36 * back + 0.03)
        rotations[f"forearm.{side}"] = _about_y(-0.22 - 0.25 * np.maximum(-back, 0.0))
    return rotations


def _leg_lengths(body: Body, side: str) -> tuple[float, float]:
    hip, knee, ankle = (body.joint(f"{bone}.{side}") for bone in ("thigh", "shin", "foot"))
    return float(np.linalg.norm(knee - hip)), float(np.linalg.norm(ankle - knee))


def _between(rest: np.ndarray, along: np.ndarray, left: np.ndarray) -> Rotations:
    """The rotations that take the direction `rest` to `along`, and the body's left to `left` as far as can be."""
    return _frame(along, left) @ np.swapaxes(_frame(rest[None], np.array([[0.0, 1.0, 0.0]])), 1, 2)


def _frame(along: np.ndarray, left: np.ndarray) -> Rotations:
    """Right-handed axes: the direction, the left made orthogonal to it, and what stands on both."""
    first = along / np.linalg.norm(along, axis=1, keepdims=True)
    second = left - np.einsum("mi,mi->m", left, first)[:, None] * first
    second /= np.linalg.norm(second, axis=1, keepdims=True)
    return np.stack([first, second, np.cross(first, second)], axis=-1)


def _turned_about(axis: np.ndarray, angle: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """The vectors turned about axes that are orthogonal to them."""
    return vector * np.cos(angle)[:, None] + np.cross(axis, vector) * np.sin(angle)[:, None]


def _about_y(angle: Float[np.ndarray, "moment"]) -> Rotations:
    """Rotations about the lateral axis: positive takes forward down."""
    cosine, sine, zero, one = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    rows = [[cosine, zero, sine], [zero, one, zero], [-sine, zero, cosine]]
    return np.moveaxis(np.array(rows), -1, 0)


def _about_z(angle: Float[np.ndarray, "moment"]) -> Rotations:
    """Rotations about the vertical: positive takes x towards y."""
    cosine, sine, zero, one = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    rows = [[cosine, -sine, zero], [sine, cosine, zero], [zero, zero, one]]
    return np.moveaxis(np.array(rows), -1, 0)
