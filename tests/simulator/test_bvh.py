"""Captured motions: files in any rotation order, errors that name the line, and bones that point as was captured."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from recording.errors import InputError
from recording.verify import verify
from simulator.body import SIDES, Body, body_names, load_body
from simulator.bvh import read_bvh
from simulator.motion_file import Motion
from simulator.retarget import ground_track, performing_person
from simulator.scene import load_scene
from simulator.simulate import prepared, simulate
from simulator.stage import walkers_centres
from simulator.variation import varied

ARM = ["Shoulder 0 0 0", "Arm {s}4 0 0", "ForeArm {s}6 0 0", "Hand {s}5 0 0"]
LEG = ["HipJoint 0 0 0", "UpLeg {s}2 -1 0", "Leg 0 -8 0", "Foot 0 -8 0", "ToeBase 0 -1 3"]
HEIGHT = 18.0
"""Of the root above the ground, in the file's unit."""
SCENE = """
name = "captured"
frames = 4
fps = 10
camera = {{width = 48, height = 36, position = [4, -0.5, 1.2], look_at = [0, 0, 1]}}
[[people]]
body = "man"
motion = {{file = "wave.bvh"{more}}}
[[people.props]]
kind = "suitcase"
side = "right"
[[people]]
body = "woman"
waypoints = [[-3, -1.5], [-3, 1.5]]
speed = 1.2
"""


def chain(parts: list[str], side: str, end: str, order: str) -> str:
    """Joints nested in one another, then an end site."""
    text = f"End Site {{ OFFSET {end} }}"
    for part in reversed(parts):
        name, offset = part.format(s="" if side == "Left" else "-").split(maxsplit=1)
        channels = " ".join(f"{axis}rotation" for axis in order)
        text = f"JOINT {side}{name}\n{{\nOFFSET {offset}\nCHANNELS 3 {channels}\n{text}\n}}"
    return text


def bvh(turns: dict[str, Rotation], root: np.ndarray, order: str = "ZYX", frame_time: float = 0.1) -> str:
    """A body with arms spread; `turns` are joints' rotations in each frame, `root` the root's place on the ground."""
    arms = [chain(ARM, side, "0 -1 0", order) for side in ("Left", "Right")]
    legs = [chain(LEG, side, "0 0 1", order) for side in ("Left", "Right")]
    head = chain(["Neck 0 3 0", "Neck1 0 1 0", "Head 0 1 0"], "", "0 2 0", order)
    spine1 = (
        f"JOINT Spine1\n{{\nOFFSET 0 3 0\nCHANNELS 3 {rotation_channels(order)}\n{head}\n" + "\n".join(arms) + "\n}"
    )
    back = f"JOINT LowerBack\n{{\nOFFSET 0 1 0\nCHANNELS 3 {rotation_channels(order)}\n{spine1}\n}}"
    hierarchy = (
        f"HIERARCHY\nROOT cmu:Hips\n{{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition "
        f"{rotation_channels(order)}\n{back}\n" + "\n".join(legs) + "\n}\n"
    )
    joints = [line.split()[1].split(":")[-1] for line in hierarchy.splitlines() if line[:4] in ("ROOT", "JOIN")]
    rest = Rotation.identity(len(root))
    angles = [turns.get(joint, rest).as_euler(order, degrees=True) for joint in joints]
    rows = np.concatenate([root[:, :1], np.full((len(root), 1), HEIGHT), root[:, 1:], *angles], axis=1)
    numbers = "\n".join(" ".join(f"{value:.6f}" for value in row) for row in rows)
    return f"{hierarchy}MOTION\nFrames: {len(root)}\nFrame Time: {frame_time}\n{numbers}\n"


def rotation_channels(order: str) -> str:
    return " ".join(f"{axis}rotation" for axis in order)


def arms_down(raised: np.ndarray) -> dict[str, Rotation]:
    """Both arms hang, the left one raised from there sideways by so much, radians."""
    return {
        "LeftArm": Rotation.from_euler("z", (raised - np.pi / 2)[:, None]),
        "RightArm": Rotation.from_euler("z", np.full((len(raised), 1), np.pi / 2)),
    }


def wave(frames: int = 6) -> str:
    return bvh(arms_down(np.linspace(0.0, 0.9 * np.pi, frames)), np.zeros((frames, 2)))


def joint_of(body: Body, vertices: np.ndarray, bone: str) -> np.ndarray:
    """Where a bone's joint is in every frame, by the mesh alone: the skinning solved for the bones."""
    skin = np.pad(body.vertices.astype(np.float64), ((0, 0), (0, 1)), constant_values=1.0)
    carried = (body.weights[:, :, None] * skin[:, None, :]).reshape(len(skin), -1)
    frames = vertices.swapaxes(0, 1).reshape(len(skin), -1).astype(np.float64)
    transforms = np.linalg.lstsq(carried, frames, rcond=None)[0].reshape(len(body.bones), 4, len(vertices), 3)
    return np.einsum("i,ifj->fj", np.append(body.joint(bone), 1.0), transforms[body.bones.index(bone)])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "wave.bvh").write_text(wave())
    return tmp_path


@pytest.mark.parametrize("order", ["ZYX", "XYZ", "YXZ", "ZXY"])
def test_rotations_are_read_in_any_order(tmp_path: Path, order: str) -> None:
    turns = Rotation.random(5, rng=np.random.default_rng(3))
    (tmp_path / "a.bvh").write_text(bvh({"LeftLeg": turns}, np.zeros((5, 2)), order))
    clip = read_bvh(tmp_path / "a.bvh")
    assert (clip.rotations[clip.joints.index("LeftLeg")] * turns.inv()).magnitude().max() < 1e-6
    assert clip.joints[0] == "Hips"
    np.testing.assert_allclose(clip.rest[clip.joints.index("LeftFoot")], [2, -17, 0])
    np.testing.assert_allclose(clip.root, np.tile([0, HEIGHT, 0], (5, 1)))


@pytest.mark.parametrize("name", body_names())
def test_the_raised_arm_points_where_the_captured_one_does(folder: Path, name: str) -> None:
    body, motion = load_body(name), Motion(file="wave.bvh", folder=str(folder))
    vertices = performing_person(body, motion, np.arange(6) / 10).vertices
    shoulder, elbow, hand = (joint_of(body, vertices, f"{bone}.L") for bone in ("upper_arm", "forearm", "hand"))
    raised = np.linspace(0.0, 0.9 * np.pi, 6)
    captured = np.stack([np.zeros(6), np.sin(raised), -np.cos(raised)], axis=1)
    for arm in (elbow - shoulder, hand - elbow):
        np.testing.assert_allclose(arm / np.linalg.norm(arm, axis=1, keepdims=True), captured, atol=1e-3)
    for bone in ("hand.R", "head", "toes.L"):
        still = joint_of(body, vertices, bone)
        assert np.linalg.norm(still - still[0], axis=1).max() < 1e-4


def test_arms_spread_at_rest_are_spread_on_the_body(tmp_path: Path) -> None:
    (tmp_path / "rest.bvh").write_text(bvh({}, np.zeros((1, 2))))
    body = load_body("man")
    motion = Motion(file="rest.bvh", folder=str(tmp_path), heading_deg=90, position=(1, 2))
    vertices = performing_person(body, motion, np.arange(3) / 10).vertices
    left, right = (joint_of(body, vertices, f"hand.{side}") for side in SIDES)
    assert (left - right)[0, 0] < -1.2  # Facing y, left is at -x.
    assert abs((left - right)[0, 2]) < 1e-4
    assert abs((left - joint_of(body, vertices, "upper_arm.L"))[0, 2]) < 1e-4
    assert np.ptp(vertices, axis=0).max() < 1e-6
    for side in SIDES:
        feet = vertices[0][body.weights[:, body.bones.index(f"foot.{side}")] > 0.95]
        assert abs(feet[:, 2].min()) < 0.01


def test_somebody_who_goes_a_metre_goes_it_where_the_scene_says(tmp_path: Path) -> None:
    ahead = np.stack([np.zeros(11), np.linspace(0.0, 10.0, 11)], axis=1)
    (tmp_path / "go.bvh").write_text(bvh(arms_down(np.zeros(11)), ahead))
    body = load_body("man")
    metre = sum(np.linalg.norm(body.joint(a) - body.joint(b)) for a, b in (("thigh.L", "shin.L"), ("shin.L", "foot.L")))
    motion = Motion(file="go.bvh", folder=str(tmp_path), heading_deg=90, position=(1, 2))
    times = np.arange(0.0, 1.2, 0.05)
    track = ground_track(body, motion, times)
    np.testing.assert_allclose(track[:, 0], 1.0, atol=1e-9)
    np.testing.assert_allclose(track[:, 1], 2 + np.minimum(times, 1.0) * metre * 10 / 16, atol=1e-9)
    vertices = performing_person(body, motion, times).vertices
    assert np.abs(vertices[..., 2].min(axis=1)).max() < 1e-3
    middle = vertices[:, :, :2].mean(axis=1) - track
    assert np.abs(middle - middle[0]).max() < 1e-4
    later = ground_track(body, motion.model_copy(update={"start_s": 0.5}), times)
    np.testing.assert_allclose(later[0], [1, 2], atol=1e-9)
    np.testing.assert_allclose(later[-1], [1, 2 + metre * 5 / 16], atol=1e-9)


def test_a_jump_leaves_the_ground_and_bent_knees_stay_on_it(tmp_path: Path) -> None:
    text = bvh(arms_down(np.zeros(20)), np.zeros((20, 2)))
    (tmp_path / "jump.bvh").write_text(text.replace(f" {HEIGHT:.6f} ", " 22.000000 ", 1))
    motion = Motion(file="jump.bvh", folder=str(tmp_path))
    lowest = performing_person(load_body("teen"), motion, np.arange(20) / 10).vertices[..., 2].min(axis=1)
    assert lowest[0] > 0.1
    assert np.abs(lowest[1:]).max() < 1e-4


def test_splayed_legs_at_rest_do_not_splay_the_body(tmp_path: Path) -> None:
    splay = Rotation.from_euler("z", [[0.3]] * 2)
    splayed = np.round(splay.apply([0.0, -8.0, 0.0])[0], 6)
    text = bvh({"LeftUpLeg": splay.inv()}, np.zeros((2, 2)))
    offset = " ".join(str(value) for value in splayed)
    for joint in ("LeftLeg", "LeftFoot"):
        text = text.replace(f"JOINT {joint}\n{{\nOFFSET 0 -8 0", f"JOINT {joint}\n{{\nOFFSET {offset}")
    toes = " ".join(str(value) for value in np.round(splay.apply([0.0, -1.0, 3.0])[0], 6))
    text = text.replace("JOINT LeftToeBase\n{\nOFFSET 0 -1 3", f"JOINT LeftToeBase\n{{\nOFFSET {toes}")
    (tmp_path / "splayed.bvh").write_text(text)
    (tmp_path / "plain.bvh").write_text(bvh({}, np.zeros((2, 2))))
    body, times = load_body("woman"), np.zeros(1)
    one, other = (
        performing_person(body, Motion(file=file, folder=str(tmp_path)), times).vertices
        for file in ("splayed.bvh", "plain.bvh")
    )
    assert np.abs(joint_of(body, one, "toes.L") - joint_of(body, other, "toes.L")).max() < 0.02
    assert np.abs(joint_of(body, one, "shin.L") - joint_of(body, other, "shin.L")).max() < 0.02


def test_a_scene_performs_the_file_beside_it_and_passes_verify(folder: Path) -> None:
    (folder / "mine.toml").write_text(SCENE.format(more=", heading_deg = 20, position = [0.2, 0.1]"))
    recording = simulate(folder / "mine.toml", frames=4)
    report = verify(recording)
    assert report.passes, report.text
    document = recording.metadata.scene or {}
    motion = document["people"][0]["motion"]
    assert len(motion["sha256"]) == 64
    assert str(folder) not in str(document)
    assert "motion" not in document["people"][1]
    assert prepared(folder / "mine.toml").metadata.scene_digest == recording.metadata.scene_digest


def test_feet_that_slide_are_seen_by_verify(folder: Path) -> None:
    (folder / "wave.bvh").write_text(bvh({}, np.stack([np.zeros(6), np.linspace(0, 10, 6)], axis=1)))
    (folder / "mine.toml").write_text(SCENE.format(more=""))
    failed = [check.name for check in verify(simulate(folder / "mine.toml")).checks if not check.passes]
    assert failed == ["feet slide"]


def test_another_day_shifts_the_performance_sideways(folder: Path) -> None:
    (folder / "mine.toml").write_text(SCENE.format(more=""))
    scene = load_scene(folder / "mine.toml")
    day = varied(scene, 4)
    before, after = walkers_centres(scene)[0], walkers_centres(day)[0]
    np.testing.assert_allclose(after[:, 0], before[:, 0], atol=1e-6)
    assert 0 < abs(after[0, 1] - before[0, 1]) <= scene.vary.sideways_m
    assert prepared(folder / "mine.toml", seed=4, size="2x").scene.people == day.people


def test_a_file_that_has_changed_is_refused(folder: Path) -> None:
    (folder / "mine.toml").write_text(SCENE.format(more=""))
    scene = load_scene(folder / "mine.toml")
    (folder / "wave.bvh").write_text(wave(7))
    with pytest.raises(InputError, match="expected the file with the SHA-256"):
        prepared(scene)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (("HIERARCHY", "once upon"), r"wave\.bvh, line 1: expected 'HIERARCHY', got 'once'"),
        (("Zrotation", "Wrotation"), "line 5: expected another one of the channels Xposition, .* got 'Wrotation'"),
        (("CHANNELS 3", "CHANNELS 7"), "line 9: expected a number of channels, 0 to 6, got '7'"),
        (("OFFSET 0 1 0", "OFFSET 0 one 0"), "line 8: expected an offset's y, got 'one'"),
        (("JOINT Spine1", "JOINT LowerBack"), "every joint's name once, got 'LowerBack'"),
        (("Frames: 6", "Frames: 7"), "expected 7 frames, got 6: it is truncated"),
        (("Frames: 6", "Frames: 5"), "expected the end after 5 frames, got another one"),
        (("Frames: 6", "Frames: 0"), "expected a number of frames, 1 or more, got '0'"),
        (("Frame Time: 0.1", "Frame Time: 0"), "expected seconds from frame to frame, above 0"),
        (("18.000000", "nan"), r"line \d+: expected finite numbers, got 'nan'"),
        (("18.000000", "18 1"), r"line \d+: expected 75 numbers, one for each channel, got 76"),
        (("LeftUpLeg", "LeftThigh"), "expected a joint 'LeftUpLeg' as in the CMU skeleton"),
    ],
)
def test_what_cannot_be_read_is_named_by_file_and_line(folder: Path, change: tuple[str, str], sentence: str) -> None:
    (folder / "wave.bvh").write_text(wave().replace(*change, 1))
    (folder / "mine.toml").write_text(SCENE.format(more=""))
    with pytest.raises(InputError, match=sentence):
        prepared(folder / "mine.toml")


@pytest.mark.parametrize("share", [0.0, 0.2, 0.6])
def test_a_hierarchy_that_ends_too_soon_is_truncated(folder: Path, share: float) -> None:
    hierarchy = wave().split("MOTION")[0]
    (folder / "wave.bvh").write_text(hierarchy[: int(share * len(hierarchy))].rsplit("\n", 1)[0])
    with pytest.raises(InputError, match="but the file ends: it is truncated or no BVH file"):
        read_bvh(folder / "wave.bvh")


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        ("}\nspeed = 1 # ", "expected 'motion' in place of way-points"),
        (", start_s = -1", "start_s: input should be greater than or equal to 0"),
        (", heading = 3", "unknown key 'heading', did you mean 'heading_deg'"),
        (", sha256 = 'abc'", "expected the file with the SHA-256 abc"),
    ],
)
def test_what_is_impossible_in_a_scene_is_refused(folder: Path, more: str, sentence: str) -> None:
    (folder / "mine.toml").write_text(SCENE.format(more=more))
    with pytest.raises(InputError, match=sentence):
        load_scene(folder / "mine.toml")


@pytest.mark.parametrize("file", ["../wave.bvh", "/etc/passwd", "link.bvh", "none.bvh"])
def test_a_file_that_is_elsewhere_or_nowhere_is_refused(folder: Path, file: str) -> None:
    inner = folder / "scenes"
    inner.mkdir()
    (inner / "link.bvh").symlink_to(folder / "wave.bvh")
    (inner / "mine.toml").write_text(SCENE.format(more="").replace("wave.bvh", file))
    with pytest.raises(InputError, match=r"in the scene's folder|none\.bvh: expected a readable BVH file"):
        load_scene(inner / "mine.toml")
