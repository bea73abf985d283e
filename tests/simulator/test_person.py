"""Walking persons: feet that neither slide nor sink, on every kind of path."""

from collections.abc import Iterator

import numpy as np
import pytest

from recording.feet import foot_sink_m, foot_slide_m
from simulator.body import SIDES, Body, load_body
from simulator.path import Path, path_through
from simulator.person import Walker, walking_person

FPS = 30
LARGEST_SLIDE = 0.02
"""Metres, at any moment by the mesh alone and within a planned stance; more is what people see."""
TOUCHING = 0.012
"""Height below which a vertex of the sole is on the ground, metres."""
ARC = [(2 * float(np.cos(angle)), 2 * float(np.sin(angle))) for angle in np.linspace(0.0, 4.0, 9)]
PATHS = {
    "slowly": path_through([(0.0, 0.0), (2.0, 0.0)], speed=0.15),
    "at ease": path_through([(0.0, 0.0), (3.0, 0.0)], speed=0.7),
    "briskly": path_through([(-3.0, 0.0), (9.0, 0.0)], speed=1.4),
    "fast": path_through([(-5.0, 0.0), (9.0, 0.0)], speed=2.0),
    "round": path_through(ARC, speed=1.2),
    "u-turn": path_through([(0.0, 0.0), (2.0, 0.0), (2.5, 0.5), (2.0, 1.0), (0.0, 1.0)], speed=1.0),
    "stop and go": path_through([(0.0, 0.0), (2.0, 0.0), (2.0, 0.0), (4.0, 0.0)], times=[0.0, 2.0, 3.0, 5.0]),
    "turn on the spot": path_through([(0.0, 0.0), (2.0, 0.0), (2.0, 0.0), (0.0, 0.3)], times=[0.0, 2.0, 3.5, 5.5]),
    "waits, goes, stops": path_through([(0.0, 0.0), (2.0, 0.0)], speed=1.3, start=1.2),
    "stands": path_through([(0.0, 0.0), (1.0, 0.0)], speed=1.0, start=60.0),
}


def walked(body: Body, path: Path, phase: float, frames: int = 150) -> Walker:
    return walking_person(body, path, np.arange(frames) / FPS, phase=phase)


def soles(body: Body) -> Iterator[tuple[int, np.ndarray]]:
    """Each side's vertices that are on the ground at rest and belong to the foot alone."""
    for side, name in enumerate(SIDES):
        foot = body.weights[:, body.bones.index(f"foot.{name}")] + body.weights[:, body.bones.index(f"toes.{name}")]
        yield side, np.flatnonzero((foot > 0.95) & (body.vertices[:, 2] < 0.02))


def stances(down: np.ndarray) -> Iterator[slice]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], down, [False]])))
    for first, last in edges.reshape(-1, 2):
        yield slice(int(first), int(last))


def largest_slide(body: Body, walker: Walker) -> float:
    """The farthest that a vertex of the sole moves within one stance while it touches the ground, metres."""
    worst = 0.0
    for side, sole in soles(body):
        for stance in stances(walker.stance[:, side]):
            skin = walker.mesh.vertices[stance][:, sole].astype(np.float64)
            for vertex in range(len(sole)):
                touching = skin[skin[:, vertex, 2] < TOUCHING, vertex, :2]
                if len(touching):
                    worst = max(worst, float(np.linalg.norm(touching - touching[0], axis=1).max()))
    return worst


@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS.keys())
@pytest.mark.parametrize("name", ["man", "woman", "heavy", "teen"])
def test_feet_neither_slide_nor_sink_nor_float(name: str, path: Path) -> None:
    body = load_body(name)
    for phase in (0.0, 0.3, 0.6, 0.85):
        walker = walked(body, path, phase)
        assert largest_slide(body, walker) < LARGEST_SLIDE
        assert foot_slide_m(walker.mesh) < LARGEST_SLIDE
        assert foot_sink_m(walker.mesh) < LARGEST_SLIDE
        for side, sole in soles(body):
            lowest = walker.mesh.vertices[:, sole, 2].min(axis=1)
            assert lowest.min() > -0.01
            assert lowest[walker.stance[:, side]].max(initial=0.0) < 0.02


def test_the_slide_that_is_looked_for_would_be_seen() -> None:
    body = load_body("man")
    walker = walked(body, PATHS["briskly"], 0.0)
    drift = np.linspace(0.0, 1.0, len(walker.stance))[:, None, None] * np.array([1.0, 0.0, 0.0])
    walker.mesh.vertices[:] += drift.astype(np.float32)
    assert largest_slide(body, walker) > LARGEST_SLIDE
    assert foot_slide_m(walker.mesh) > LARGEST_SLIDE


@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS.keys())
def test_no_limb_jumps(path: Path) -> None:
    fine = 120  # Frames a second: two frames of a smooth motion are then near each other.
    walker = walking_person(load_body("man"), path, np.arange(5 * fine) / fine, phase=0.3)
    speed = np.linalg.norm(np.diff(walker.mesh.vertices, axis=0), axis=2).max(axis=1) * fine
    assert speed.max() < 12.0  # The swinging foot of somebody who walks at 2 m/s: 10 m/s.


def around_joint(body: Body, walker: Walker, bone: str) -> np.ndarray:
    """The middle of the dozen vertices nearest to a joint at rest, in every frame."""
    near = np.argsort(np.linalg.norm(body.vertices - body.joint(bone), axis=1))[:12]
    return walker.mesh.vertices[:, near].mean(axis=1)


def test_arms_swing_against_the_legs() -> None:
    body = load_body("man")
    frames = np.arange(120) / FPS
    path = PATHS["briskly"]
    walker = walking_person(body, path, frames, phase=0.0)
    here = path.positions(frames)[:, 0]
    limbs = ("hand.L", "hand.R", "foot.L", "foot.R")
    forward = {bone: around_joint(body, walker, bone)[:, 0] - here for bone in limbs}
    assert np.corrcoef(forward["foot.L"], forward["foot.R"])[0, 1] < -0.7
    for side, other in (("L", "R"), ("R", "L")):
        assert np.corrcoef(forward[f"hand.{side}"], forward[f"foot.{side}"])[0, 1] < -0.7
        assert np.corrcoef(forward[f"hand.{side}"], forward[f"foot.{other}"])[0, 1] > 0.7


@pytest.mark.parametrize("side", SIDES)
def test_knees_bend_forward(side: str) -> None:
    body = load_body("man")
    walker = walked(body, PATHS["briskly"], 0.0)
    hip, knee, ankle = (around_joint(body, walker, f"{bone}.{side}") for bone in ("thigh", "shin", "foot"))
    share = (hip[:, 2] - knee[:, 2]) / (hip[:, 2] - ankle[:, 2])
    before_the_line = knee[:, 0] - (hip[:, 0] + share * (ankle[:, 0] - hip[:, 0]))
    assert before_the_line.min() > -0.03  # A straight leg, and the skin is not the joint.
    assert before_the_line.max() > 0.1


def test_the_body_faces_where_it_goes() -> None:
    body = load_body("woman")
    walker = walked(body, PATHS["round"], 0.2)
    head = np.flatnonzero(body.weights[:, body.bones.index("head")] > 0.9)
    nose = head[np.argmax(body.vertices[head, 0])]
    centre = walker.mesh.vertices[:, head].mean(axis=1)
    facing = (walker.mesh.vertices[:, nose] - centre)[:100, :2]
    going = np.gradient(centre[:, :2], axis=0)[:100]
    cosine = (facing * going).sum(axis=1) / np.linalg.norm(facing, axis=1) / np.linalg.norm(going, axis=1)
    assert cosine.min() > 0.9


def test_somebody_who_stands_does_not_move_at_all() -> None:
    vertices = walked(load_body("teen"), PATHS["stands"], 0.4).mesh.vertices
    assert np.abs(vertices - vertices[0]).max() < 1e-6


def test_the_walk_is_the_same_at_any_frame_rate() -> None:
    body, path = load_body("man"), PATHS["u-turn"]
    slow, fast = (walking_person(body, path, np.arange(0.0, 3.0, 1 / fps), phase=0.1) for fps in (15, 30))
    np.testing.assert_allclose(slow.mesh.vertices, fast.mesh.vertices[::2], atol=0.03)
