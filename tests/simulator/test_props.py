"""Props: they follow who carries them, count as part of the person, and stay off the ground."""

import numpy as np
import pytest
from scipy.spatial import Delaunay

from recording.checks import validated
from recording.errors import InputError
from recording.feet import foot_sink_m, foot_slide_m
from recording.truth import MeshSequence
from recording.verify import verify
from simulator.body import Body, body_names, load_body
from simulator.dressing import dressed, holding
from simulator.path import path_through
from simulator.person import walking_person
from simulator.props import Coat, Prop, Suitcase, Umbrella
from simulator.scene import Scene
from simulator.simulate import simulate

PATH = path_through([(-3.0, 0.0), (3.0, 0.0)], speed=1.3)
TIMES = np.arange(24) / 15
EVERY_BODY = pytest.mark.parametrize("name", body_names())


def carried(body: Body, *props: Prop, bare: bool = False) -> MeshSequence:
    """The body walking with its props; or as bare as it would be but for the props' arms."""
    whole = body if bare else dressed(body, props)
    return walking_person(whole, PATH, TIMES, phase=0.2, holding=holding(body, props)).mesh


def part(body: Body, mesh: MeshSequence) -> np.ndarray:
    """The vertices that are not the body's own, in every frame."""
    return mesh.vertices[:, len(body.vertices) :].astype(np.float64)


def test_a_prop_leaves_the_body_as_it_is() -> None:
    body = load_body("woman")
    props = (Coat(kind="coat"), Umbrella(kind="umbrella"), Suitcase(kind="suitcase", side="left"))
    whole = dressed(body, props)
    np.testing.assert_array_equal(whole.vertices[: len(body.vertices)], body.vertices)
    np.testing.assert_array_equal(whole.faces[: len(body.faces)], body.faces)
    np.testing.assert_allclose(whole.weights.sum(axis=1), 1.0, atol=1e-5)
    assert whole.faces.max() == len(whole.vertices) - 1
    np.testing.assert_array_equal(
        carried(body, *props).vertices[:, : len(body.vertices)], carried(body, *props, bare=True).vertices
    )


def test_without_props_nothing_changes() -> None:
    body = load_body("man")
    plain = walking_person(body, PATH, TIMES, phase=0.2).mesh
    np.testing.assert_array_equal(carried(body).vertices, plain.vertices)


@EVERY_BODY
@pytest.mark.parametrize("side", ["left", "right"])
def test_an_umbrella_is_above_the_head_and_covers_it(name: str, side: str) -> None:
    body = load_body(name)
    mesh = carried(body, Umbrella.model_validate({"kind": "umbrella", "side": side}))
    own = mesh.vertices[:, : len(body.vertices)]
    head = own[:, body.weights[:, body.bones.index("head")] > 0.5]
    prop = part(body, mesh)
    middle = prop[..., :2].mean(axis=1)
    rim = np.linalg.norm(prop[..., :2] - middle[:, None], axis=-1) > 0.35  # Only the cloth is so wide.
    assert prop[rim].reshape(-1, 3)[:, 2].min() > body.height - 0.1
    assert np.linalg.norm(middle - head[..., :2].mean(axis=1), axis=1).max() < 0.25
    assert np.linalg.norm(np.ptp(prop[..., :2], axis=1), axis=1).min() > 1.2


@EVERY_BODY
@pytest.mark.parametrize("side", ["left", "right"])
def test_a_suitcase_hangs_upright_beside_the_leg_and_off_the_ground(name: str, side: str) -> None:
    body = load_body(name)
    mesh = carried(body, Suitcase.model_validate({"kind": "suitcase", "side": side}))
    prop = part(body, mesh)
    assert prop[..., 2].min() > 0.15
    np.testing.assert_allclose(np.ptp(prop[..., 2], axis=1), np.ptp(prop[0, :, 2]), atol=1e-3)  # It never tilts.
    legs = body.weights[:, [body.bones.index(f"{bone}.{side[0].upper()}") for bone in ("thigh", "shin")]].sum(axis=1)
    leg = mesh.vertices[:, : len(body.vertices)][:, legs > 0.9]
    sign = 1.0 if side == "left" else -1.0  # The walk goes along x: y is to the left.
    below = leg[..., 2] < prop[..., 2].max()
    assert (sign * leg[..., 1])[below].max() < (sign * prop[..., 1]).min() + 0.03


@EVERY_BODY
def test_legs_stay_under_a_coat_and_the_torso_in_it(name: str) -> None:
    body = load_body(name)
    mesh = carried(body, Coat(kind="coat"))
    thighs = body.weights[:, [body.bones.index(f"thigh.{side}") for side in "LR"]].sum(axis=1) > 0.95
    outside = []
    for vertices in mesh.vertices[::6]:
        coat = Delaunay(vertices[len(body.vertices) :].astype(np.float64))  # As much as lies between its points.
        outside.append(float(np.mean(coat.find_simplex(vertices[: len(body.vertices)][thighs]) < 0)))
    assert max(outside) < 0.02
    assert part(body, mesh)[..., 2].min() > 0.2


def test_an_arm_that_holds_something_does_not_swing() -> None:
    body = load_body("man")
    held, free = (carried(body, *props, bare=True).vertices for props in ((Suitcase(kind="suitcase"),), ()))
    swings = []
    for vertices in (held, free):
        hand = vertices[:, body.weights[:, body.bones.index("hand.R")] > 0.9].mean(axis=1)
        hips = vertices[:, body.weights[:, body.bones.index("pelvis")] > 0.7].mean(axis=1)
        swings.append(float(np.ptp((hand - hips)[:, 0])))
    assert swings[0] < 0.1
    assert swings[1] > 0.3


@EVERY_BODY
def test_no_prop_is_taken_for_a_foot(name: str) -> None:
    body = load_body(name)
    props = (Coat(kind="coat"), Umbrella(kind="umbrella"), Suitcase(kind="suitcase", side="left"))
    whole, bare = carried(body, *props), carried(body, *props, bare=True)
    assert foot_slide_m(whole) == foot_slide_m(bare)
    assert foot_sink_m(whole) == foot_sink_m(bare)


def test_a_recording_shows_a_prop_as_its_carrier() -> None:
    scene = {
        "name": "carrier",
        "frames": 3,
        "fps": 10,
        "camera": {"width": 64, "height": 48, "position": [0, -4, 1.4], "look_at": [0, 0, 1.1]},
        "people": [{"body": "man", "waypoints": [[-1, 0], [1, 0]], "speed": 1, "start": -0.5}],
    }
    props = [{"kind": "umbrella"}, {"kind": "suitcase", "side": "left"}, {"kind": "coat"}]
    dressed_scene = scene | {"people": [scene["people"][0] | {"props": props}]}
    bare, whole = (simulate(Scene.model_validate(document)) for document in (scene, dressed_scene))
    assert verify(whole).passes, verify(whole).text
    assert len(whole.metadata.objects or ()) == 1
    for number, frame in enumerate(whole.frames):
        assert np.unique(frame.labels.objectid).tolist() == [0, 1]
        assert frame.seen.sum() > 1.4 * bare.frames[number].seen.sum()


def test_one_hand_holds_one_thing() -> None:
    person = {"body": "man", "waypoints": [[0, 0], [1, 0]], "speed": 1}
    camera = {"position": [0, -4, 1], "look_at": [0, 0, 1]}
    twice = {"props": [{"kind": "umbrella"}, {"kind": "suitcase"}]}
    document = {"name": "a", "frames": 1, "fps": 1, "camera": camera, "people": [person | twice]}
    with pytest.raises(
        ValueError, match="one thing at the most for each hand and one coat, got two for the right hand"
    ):
        Scene.model_validate(document)


@pytest.mark.parametrize(
    ("prop", "sentence"),
    [
        ({"kind": "hat"}, "people.0.props.0.kind: input should be 'umbrella' or 'suitcase' or 'coat', got 'hat'"),
        ({"side": "left"}, "key 'people.0.props.0.kind' is missing"),
        ({"kind": "coat", "flar": 0.1}, "unknown key 'people.0.props.0.flar', did you mean 'flare'"),
        ({"kind": "suitcase", "size": [0.5, 0.2, 0.9]}, "props.0.size.2: .* less than or equal to 0.5"),
    ],
)
def test_an_impossible_prop_is_refused_by_name(prop: dict[str, object], sentence: str) -> None:
    person = {"body": "man", "waypoints": [[0, 0], [1, 0]], "speed": 1, "props": [prop]}
    camera = {"position": [0, -4, 1], "look_at": [0, 0, 1]}
    document = {"name": "a", "frames": 1, "fps": 1, "camera": camera, "people": [person]}
    with pytest.raises(InputError, match=sentence):
        validated(Scene, document, source="test")
