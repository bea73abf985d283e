"""Bodies: what is stored, and linear blend skinning."""

import numpy as np
import pytest

from recording.errors import InputError
from simulator.body import ASSETS, SIDES, Body, body_names, bone_transforms, load_body, posed

BODIES = ("heavy", "man", "teen", "woman")


def about_z(angle: float) -> np.ndarray:
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def naively_posed(body: Body, rotations: dict[str, np.ndarray], root: np.ndarray) -> np.ndarray:
    """One vertex, one bone, one frame at a time."""
    turns, places = bone_transforms(body, rotations, root)
    skin = np.zeros((len(root), len(body.vertices), 3))
    for frame in range(len(root)):
        for bone in range(len(body.bones)):
            carried = (body.vertices - body.joints[bone]) @ turns[frame, bone].T + places[frame, bone]
            skin[frame] += body.weights[:, bone, None] * carried
    return skin


def test_the_four_bodies_are_there() -> None:
    assert tuple(body_names()) == BODIES


@pytest.mark.parametrize("name", BODIES)
def test_a_body_is_small_upright_and_closed_under_its_skeleton(name: str) -> None:
    body = load_body(name)
    assert len((ASSETS / f"body_{name}.npz").read_bytes()) < 75_000
    assert len(body.faces) == 3000
    assert body.faces.max() == len(body.vertices) - 1
    assert 1.5 < body.height < 1.9
    assert body.vertices[:, 2].min() == pytest.approx(0.0, abs=3e-3)  # As near as the simplified sole is.
    np.testing.assert_allclose(body.weights.sum(axis=1), 1.0, atol=1e-5)
    assert body.parents[0] == -1
    assert (body.parents[1:] < np.arange(1, len(body.bones))).all()


@pytest.mark.parametrize("name", BODIES)
def test_a_body_faces_forward_with_its_left_on_the_left(name: str) -> None:
    body = load_body(name)
    for side, outward in zip(SIDES, (1.0, -1.0), strict=True):
        assert body.joint(f"toes.{side}")[0] > body.joint(f"foot.{side}")[0] + 0.08
        assert body.joint(f"thigh.{side}")[1] * outward > 0.05
        assert body.joint(f"hand.{side}")[2] < body.joint(f"upper_arm.{side}")[2] - 0.4  # The arm hangs.


@pytest.mark.parametrize("name", BODIES)
def test_the_skin_faces_outward(name: str) -> None:
    body = load_body(name)
    a, b, c = (body.vertices[body.faces[:, corner]].astype(np.float64) for corner in range(3))
    volume = np.einsum("fi,fi->", a, np.cross(b, c)) / 6  # Of signed tetrahedra, m^3.
    assert 0.035 < volume < 0.13


def test_no_rotation_leaves_the_body_at_rest() -> None:
    body = load_body("man")
    skin = posed(body, {}, body.joints[:1].astype(np.float64))
    assert skin.dtype == np.float32
    np.testing.assert_allclose(skin[0], body.vertices, atol=1e-5)


def test_turning_the_root_moves_the_body_rigidly() -> None:
    body = load_body("woman")
    turn, root = about_z(0.7), np.array([[3.0, -2.0, 1.1]])
    skin = posed(body, {"pelvis": turn[None]}, root)
    np.testing.assert_allclose(skin[0], (body.vertices - body.joints[0]) @ turn.T + root[0], atol=1e-5)


def test_skinning_agrees_with_a_naive_one() -> None:
    body = load_body("teen")
    generator = np.random.default_rng(0)
    frames = 3
    rotations = {
        bone: np.stack([about_z(angle) for angle in generator.uniform(-1.0, 1.0, frames)]) for bone in body.bones
    }
    root = generator.normal(size=(frames, 3))
    np.testing.assert_allclose(posed(body, rotations, root), naively_posed(body, rotations, root), atol=1e-5)


def test_a_bent_knee_leaves_the_rest_of_the_body_alone() -> None:
    body = load_body("man")
    bent = posed(body, {"shin.L": about_z(0.5)[None]}, body.joints[:1].astype(np.float64))[0]
    below = [body.bones.index(bone) for bone in ("shin.L", "foot.L", "toes.L")]
    untouched = body.weights[:, below].sum(axis=1) == 0
    assert untouched.sum() > 1000
    np.testing.assert_allclose(bent[untouched], body.vertices[untouched], atol=1e-5)


def test_an_unknown_body_is_answered_with_the_nearest_one() -> None:
    with pytest.raises(InputError, match="did you mean 'woman'"):
        load_body("womn")
