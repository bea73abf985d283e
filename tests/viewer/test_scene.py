"""The scene: which layers are shown at first, what a click picks, and that a change of frame changes what is shown."""

from collections.abc import Iterator

import numpy as np
import pytest
from by_hand import HandClock

from recording.motions import Motions
from recording.recording import Recording
from viewer.scene import SHOWN, Scene
from viewer.server import ClosedServer, opened_server
from viewer.session import Session
from viewer.surroundings import depth_picture, nearest_to_ray


@pytest.fixture
def server() -> Iterator[ClosedServer]:
    server = opened_server(host="127.0.0.1", port=0, label="test")
    yield server
    server.stop()


@pytest.fixture
def scene_of(server: ClosedServer, scene: Recording, solved: Motions) -> Scene:
    """The scene of the person who passes behind a wall."""
    return Scene(server, Session(scene, solved, clock=HandClock(), cache=None))


def click(scene: Scene, place: np.ndarray) -> None:
    """Click on a place of the world, as seen from where the viewer looks from at first."""
    eye = scene.session.space.eye
    scene.pick_along(eye, place - eye)


def test_without_motions_what_was_sensed_is_shown(server: ClosedServer, scene: Recording) -> None:
    shown = Scene(server, Session(scene, None, clock=HandClock(), cache=None)).shown
    assert {name for name, there in shown.items() if there} == {"sensed", "camera"}


def test_with_motions_their_points_and_curves_are_shown(scene_of: Scene) -> None:
    assert {name for name, there in scene_of.shown.items() if there} == set(SHOWN)


def test_a_click_picks_the_motion_of_the_point_and_one_beside_all_points_none(scene_of: Scene) -> None:
    answer = scene_of.session.answer
    assert answer is not None
    row = np.flatnonzero((answer.motions.frame == 0) & (answer.motions.motion == 0) & answer.motions.observed)[0]
    click(scene_of, answer.motions.position[row].astype(float))
    assert scene_of.session.picked == 0
    click(scene_of, scene_of.session.space.middle + np.array([0.0, 0.0, 50.0]))
    assert scene_of.session.picked is None


def test_points_of_layers_that_are_not_shown_cannot_be_picked(scene_of: Scene) -> None:
    answer = scene_of.session.answer
    assert answer is not None
    for layer in ("observed", "intra", "inter"):
        scene_of.show(layer, False)
    row = np.flatnonzero((answer.motions.frame == 0) & (answer.motions.motion == 0))[0]
    click(scene_of, answer.motions.position[row].astype(float))
    assert scene_of.session.picked is None


def test_one_frame_is_shown_at_a_time(scene_of: Scene) -> None:
    for frame in (3, 3, 7):
        scene_of.session.playback.go_to(frame)
        visible = [group.visible for group in scene_of.stage._groups]
        assert visible.count(True) == 1
        assert visible[frame]


def test_of_points_near_a_ray_the_first_is_met() -> None:
    ahead = np.array([[0.0, 0.0, 5.0], [0.0, 0.01, 2.0], [1.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    assert nearest_to_ray(ahead, np.zeros(3), np.array([0.0, 0.0, 9.0])) == 1
    assert nearest_to_ray(ahead, np.zeros(3), np.array([0.0, 1.0, 0.0])) is None
    assert nearest_to_ray(np.zeros((0, 3)), np.zeros(3), np.array([0.0, 1.0, 0.0])) is None


def test_a_depth_picture_is_white_where_nothing_returned_and_no_wider_than_needed() -> None:
    depth = np.full((10, 700), 2.0, np.float32)
    depth[0] = np.nan
    picture = depth_picture(depth, (1.0, 3.0))
    assert picture.shape == (4, 234, 3)
    assert (picture[0] == 255).all()
    assert (picture[1:] < 255).any()
