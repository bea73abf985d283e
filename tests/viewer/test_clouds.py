"""Points by frame: none is lost, each is where it was, and too many are thinned out."""

import numpy as np
from known_motions import two_motions
from worlds import plane, recorded, recording_of, sphere

from recording.visibility import surface_points
from viewer.clouds import motion_cloud, sensed_cloud, xray_cloud
from viewer.space import space_of

BALL = [sphere(lambda frame: (0.1 * frame, 0.0, 3.0), 0.4)]


def test_sensed_points_are_the_returns_of_each_frame_to_millimetres() -> None:
    recording = recorded(BALL, frames=4, moving=[True])
    space = space_of(recording, None)
    cloud = sensed_cloud(recording, space)
    for number, frame in enumerate(recording.frames):
        there = cloud.points[cloud.of(number)].astype(float) + space.middle
        np.testing.assert_allclose(there, surface_points(recording.camera, frame.depth), atol=2e-3)
        np.testing.assert_allclose(cloud.depth_m[cloud.of(number)], frame.depth[frame.seen], atol=1e-5)


def test_too_many_points_are_thinned_out_in_every_frame_alike() -> None:
    recording = recorded([plane(lambda _: 2.0)], frames=3, moving=[False])
    cloud = sensed_cloud(recording, space_of(recording, None), most=3000)
    assert cloud.step == 5  # 4800 returns, room for 1000.
    assert [cloud.of(frame).stop - cloud.of(frame).start for frame in range(3)] == [960] * 3


def test_a_recording_without_returns_has_a_cloud_without_points() -> None:
    recording = recording_of([np.full((6, 8), np.nan)] * 2)
    cloud = sensed_cloud(recording, space_of(recording, None))
    assert len(cloud.points) == 0
    assert cloud.of(1) == slice(0, 0)


def test_without_x_ray_its_cloud_has_no_points() -> None:
    recording = recorded(BALL, frames=2, moving=[True])
    assert len(xray_cloud(recording, space_of(recording, None)).points) == 0


def test_a_cloud_of_motions_knows_the_row_of_every_point() -> None:
    motions = two_motions()
    recording = recorded(BALL, frames=6, moving=[True])
    space = space_of(recording, motions)
    cloud = motion_cloud(motions, motions.observed, recording, space)
    assert cloud.row is not None
    np.testing.assert_allclose(cloud.points + space.middle, motions.position[cloud.row], atol=1e-3)
    for frame in range(6):
        assert set(motions.frame[cloud.row[cloud.of(frame)]]) == {frame}
    assert len(cloud.row) == motions.observed.sum()


def test_up_is_z_in_a_world_and_the_cameras_top_without_one() -> None:
    recording = recorded(BALL, frames=2, moving=[True])  # The camera's axes are the world's.
    space = space_of(recording, None)
    np.testing.assert_array_equal(space.up, [0, -1, 0])
    assert not space.upright
    np.testing.assert_allclose(space.forward, [0, 0, 1])
