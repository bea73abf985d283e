"""The picture of all objects, put together from each one's own, is the picture that one caster takes."""

from dataclasses import fields

import numpy as np

from recording.camera import Camera, looking_at
from simulator.backend import find_backend
from simulator.pictures import Stage, pictures
from simulator.raycast import RayCaster
from simulator.shapes import ball, box, cylinder, moved


def crowd() -> Stage:
    across = np.linspace(-1.5, 1.5, 5)[:, None]
    camera = Camera(
        width=96,
        height=72,
        fx=77.0,
        fy=77.0,
        cx=48.0,
        cy=36.0,
        world_from_camera=looking_at((0.3, -5.5, 1.5), (0.0, 0.0, 1.0)),
    )
    moving = {
        3: moved(ball(0.5), across * np.array([[1.0, 0.2, 0.1]]) + [0.0, 1.0, 1.0]),
        1: moved(ball(0.4), across * np.array([[-0.4, -0.9, 0.0]]) + [0.5, 0.5, 0.9]),
        9: moved(ball(0.4), across * 0.0 + [0.0, 40.0, 30.0]),
    }
    still = {7: box((1.2, 0.3, 2.0), (-0.6, -1.0, 0.0), yaw=0.4), 4: cylinder(0.2, 1.9, (0.9, -1.2, 0.0))}
    return Stage(camera=camera, moving=moving, still=still, frames=5)


def test_the_nearest_of_all_is_what_one_caster_sees() -> None:
    stage, backend = crowd(), find_backend()
    together = RayCaster({**stage.moving, **stage.still}, stage.camera, backend)
    for number, (frame, _) in enumerate(pictures(stage, backend)):
        hits = together.cast(number)
        assert frame.labels is not None
        for field in fields(frame.labels):
            np.testing.assert_array_equal(getattr(frame.labels, field.name), getattr(hits, field.name))
        np.testing.assert_array_equal(frame.depth, hits.depth)


def test_what_is_seen_is_to_the_bit_what_the_x_ray_shows() -> None:
    hidden = 0
    for frame, xray in pictures(crowd(), find_backend()):
        assert list(xray) == [3, 1, 9]
        assert np.isnan(xray[9]).all()
        assert frame.labels is not None
        for objectid, depth in xray.items():
            seen = frame.labels.objectid == objectid
            np.testing.assert_array_equal(frame.depth[seen], depth[seen])
            hidden += int(np.isfinite(depth[~seen]).sum())
    assert hidden > 50


def test_every_second_frame_is_as_in_the_whole_row() -> None:
    whole = list(pictures(crowd(), find_backend()))
    for begin in (0, 1):
        part = list(pictures(crowd().every(2, begin=begin), find_backend()))
        assert len(part) == len(whole[begin::2])
        for (one, _), (other, _) in zip(part, whole[begin::2], strict=True):
            assert one.depth.tobytes() == other.depth.tobytes()


def test_a_stage_without_anything_still_or_moving_is_shown() -> None:
    stage, backend = crowd(), find_backend()
    only_moving = Stage(camera=stage.camera, moving=stage.moving, still={}, frames=1)
    only_still = Stage(camera=stage.camera, moving={}, still=stage.still, frames=2)
    assert sum(len(xray) for _, xray in pictures(only_moving, backend)) == 3
    assert [len(xray) for _, xray in pictures(only_still, backend)] == [0, 0]
