"""Every pixel sees what geometry says it sees, with either backend."""

from dataclasses import fields

import numpy as np
import pytest

from recording.camera import Camera, looking_at, pixel_grid
from recording.truth import MeshSequence
from simulator.backend import Backend, find_backend
from simulator.raycast import Hits, RayCaster, casts_known_answer
from simulator.shapes import ball, box, cone, cylinder, moved


@pytest.fixture(params=["llvm", "scalar"])
def backend(request: pytest.FixtureRequest) -> Backend:
    return find_backend(request.param)


def ahead(width: int = 80, height: int = 60) -> Camera:
    """A camera at the origin that looks along the world's z."""
    return Camera(width=width, height=height, fx=70.0, fy=75.0, cx=40.3, cy=29.2, world_from_camera=np.eye(4))


def tripod(width: int = 96, height: int = 72) -> Camera:
    """A camera at eye level that looks at `crowd`."""
    return Camera(
        width=width,
        height=height,
        fx=width * 0.8,
        fy=width * 0.8,
        cx=width / 2,
        cy=height / 2,
        world_from_camera=looking_at((0.3, -5.5, 1.5), (0.0, 0.0, 1.0)),
    )


def square(depth: float) -> MeshSequence:
    """A square, 20 m wide, across the z axis."""
    corners = [[-10, -10, depth], [10, -10, depth], [10, 10, depth], [-10, 10, depth]]
    return MeshSequence(
        faces=np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32), vertices=np.array([corners], dtype=np.float32)
    )


def crowd(frames: int = 4) -> dict[int, MeshSequence]:
    """Balls that cross behind what stands still."""
    across = np.linspace(-1.5, 1.5, frames)[:, None]
    east, south = np.array([[1.0, 0.2, 0.1]]), np.array([[-0.4, -0.9, 0.0]])
    return {
        3: moved(ball(0.5), across * east + [0.0, 1.0, 1.0]),
        1: moved(ball(0.4), across * south + [0.5, 0.5, 0.9]),
        7: box((1.2, 0.3, 2.0), (-0.6, -1.0, 0.0), yaw=0.4),
        4: cylinder(0.2, 1.9, (0.9, -1.2, 0.0)),
        5: cone(0.5, 1.4, (1.8, 0.3, 0.0)),
    }


def same(one: Hits, other: Hits) -> bool:
    names = [field.name for field in fields(Hits)]
    return all(getattr(one, name).tobytes() == getattr(other, name).tobytes() for name in names)


def test_square_across_the_axis_is_everywhere_as_deep(backend: Backend) -> None:
    hits = RayCaster({5: square(3.0)}, ahead(), backend).cast(0)
    assert np.abs(hits.depth - 3.0).max() < 1e-6
    assert (hits.objectid == 5).all()
    assert set(np.unique(hits.face)) == {0, 1}


def test_ball_is_as_deep_as_its_sphere(backend: Backend) -> None:
    camera, centre, radius = ahead(), np.array([0.2, -0.1, 4.0]), 1.0
    hits = RayCaster({1: ball(radius, (0.2, -0.1, 4.0))}, camera, backend).cast(0)
    ray = camera.camera_from_pixel(pixel_grid(60, 80), np.ones((60, 80)))
    along, square_length = ray @ centre, (ray**2).sum(axis=-1)
    discriminant = along**2 - square_length * (centre @ centre - radius**2)
    middle = discriminant > 0.5  # At its rim the ball of flat faces is thinner than the sphere.
    expected = (along - np.sqrt(np.where(middle, discriminant, np.nan))) / square_length
    assert np.abs(hits.depth - expected)[middle].max() < 0.01
    assert (hits.objectid[discriminant < 0] == 0).all()


def test_depth_and_material_point_are_one_point(backend: Backend) -> None:
    camera, meshes = tripod(), crowd()
    caster = RayCaster(meshes, camera, backend)
    for frame in range(4):
        hits = caster.cast(frame)
        seen = camera.world_points(hits.depth)
        assert set(np.unique(hits.objectid)) == {0, *meshes}
        for identity, mesh in meshes.items():
            at = hits.objectid == identity
            points = mesh.material_points(
                frame=frame, face=hits.face[at], u=hits.u[at].astype(float), v=hits.v[at].astype(float)
            )
            assert np.linalg.norm(points - seen[at], axis=-1).max() < 1e-5  # 0.1 mm is asked for.


def test_what_sees_nothing_is_nan_and_zero(backend: Backend) -> None:
    hits = RayCaster(crowd(), tripod(), backend).cast(0)
    nothing = hits.objectid == 0
    assert nothing.any()
    assert np.isnan(hits.depth[nothing]).all()
    assert np.isfinite(hits.depth[~nothing]).all()
    for values in (hits.face, hits.u, hits.v):
        assert (values[nothing] == 0).all()


def test_weights_are_those_of_a_point_of_the_face(backend: Backend) -> None:
    hits = RayCaster(crowd(), tripod(), backend).cast(2)
    assert min(hits.u.min(), hits.v.min()) >= 0
    assert (hits.u + hits.v).max() <= 1 + 1e-6


@pytest.mark.parametrize("tilt_m", [0.0, 1e-7, 1e-6, 1e-5])
def test_a_sheet_seen_edge_on_is_met_where_it_is(backend: Backend, tilt_m: float) -> None:
    height, target = 1.1, (0.1, 0.0, 1.1)
    camera = Camera(
        width=64,
        height=49,
        fx=60.0,
        fy=60.0,
        cx=32.0,
        cy=24.5,
        world_from_camera=looking_at((0.1, -5.5, 1.1), target),
    )
    corners = [[-2, -1, height + tilt_m], [2, -1, height], [2.5, 3, height], [-2, 3, height + tilt_m]]
    sheet = MeshSequence(
        faces=np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32), vertices=np.array([corners], dtype=np.float32)
    )
    hits = RayCaster({1: sheet}, camera, backend).cast(0)
    at = hits.objectid == 1
    points = sheet.material_points(frame=0, face=hits.face[at], u=hits.u[at].astype(float), v=hits.v[at].astype(float))
    assert np.allclose(points, camera.world_points(hits.depth)[at], rtol=0, atol=1e-5)


def test_empty_scene_has_no_return(backend: Backend) -> None:
    hits = RayCaster({}, ahead(), backend).cast(0)
    assert hits.depth.shape == (60, 80)
    assert np.isnan(hits.depth).all()
    assert not hits.objectid.any()


def test_what_is_behind_the_camera_is_not_seen(backend: Backend) -> None:
    assert np.isnan(RayCaster({1: ball(0.5, (0.0, 0.0, -2.0))}, ahead(), backend).cast(0).depth).all()


def test_what_reaches_through_the_cameras_plane_is_seen(backend: Backend) -> None:
    floor = MeshSequence(
        faces=np.array([[0, 1, 2]], dtype=np.int32),
        vertices=np.array([[[-50, 1, -50], [50, 1, -50], [0, 1, 50]]], dtype=np.float32),
    )
    hits = RayCaster({1: floor}, ahead(), backend).cast(0)
    assert hits.depth[59, 40] == pytest.approx(75.0 / (59.5 - 29.2), rel=1e-5)
    assert np.isnan(hits.depth[:29]).all()


def test_the_nearer_object_hides_the_farther(backend: Backend) -> None:
    hits = RayCaster({1: square(5.0), 2: ball(0.5, (0.0, 0.0, 3.0))}, ahead(), backend).cast(0)
    assert hits.objectid[29, 40] == 2
    assert hits.objectid[0, 0] == 1


def test_the_order_of_objects_is_of_no_account(backend: Backend) -> None:
    forth, back = crowd(), dict(reversed(crowd().items()))
    assert same(RayCaster(forth, tripod(), backend).cast(1), RayCaster(back, tripod(), backend).cast(1))


def test_casters_live_side_by_side(backend: Backend) -> None:
    meshes, camera = crowd(), tripod()
    alone = {identity: RayCaster({identity: mesh}, camera, backend) for identity, mesh in meshes.items()}
    everything = RayCaster(meshes, camera, backend).cast(3)
    for identity, caster in alone.items():
        hits = caster.cast(3)
        assert set(np.unique(hits.objectid)) == {0, identity}
        visible = everything.objectid == identity
        assert (hits.depth[visible] == everything.depth[visible]).all()
        assert (hits.objectid > 0).sum() >= visible.sum()


def test_a_frame_has_the_same_bytes_whenever_it_is_cast(backend: Backend) -> None:
    caster = RayCaster(crowd(), tripod(), backend)
    first = caster.cast(2)
    for frame in (2, 0, 3, 2):
        again = caster.cast(frame)
    assert same(first, again)
    assert same(first, RayCaster(crowd(), tripod(), backend).cast(2))


def test_a_window_shows_its_part_of_the_picture(backend: Backend) -> None:
    caster, window = RayCaster(crowd(), tripod(), backend), (slice(20, 50), slice(31, 77))
    part, full = caster.cast(1, window), caster.cast(1)
    for field in fields(Hits):
        assert getattr(part, field.name).tobytes() == getattr(full, field.name)[window].tobytes()


def test_the_window_around_an_object_holds_all_of_it(backend: Backend) -> None:
    mesh, camera = crowd()[3], tripod()
    for frame in range(4):
        caster = RayCaster({3: mesh}, camera, backend)
        window = caster.window(frame)
        objectid = caster.cast(frame).objectid
        assert 0 < np.count_nonzero(objectid) == np.count_nonzero(caster.cast(frame, window).objectid)
        assert objectid[window].size < objectid.size / 4


def test_an_empty_window_is_an_empty_picture(backend: Backend) -> None:
    beside = ball(0.5, (30.0, 0.0, 3.0))
    caster = RayCaster({1: beside}, ahead(), backend)
    hits = caster.cast(0, caster.window(0))
    assert hits.depth.size == 0


def test_both_backends_see_the_same() -> None:
    camera, pixels, different = tripod(192, 144), 0, 0
    compiled, plain = (RayCaster(crowd(), camera, find_backend(name)) for name in ("llvm", "scalar"))
    for frame in range(4):
        one, other = compiled.cast(frame), plain.cast(frame)
        equal = (one.objectid == other.objectid) & (one.face == other.face)
        pixels, different = pixels + equal.size, different + np.count_nonzero(~equal)
        for field in ("depth", "u", "v"):
            first, second = getattr(one, field)[equal], getattr(other, field)[equal]
            assert first.tobytes() == second.tobytes(), f"{field} differs on the same face"
    assert different < 0.001 * pixels


def test_the_known_answer_is_found(backend: Backend) -> None:
    assert casts_known_answer(backend)


@pytest.mark.parametrize("identity", [0, -1])
def test_an_id_that_means_nothing_is_refused(identity: int) -> None:
    with pytest.raises(ValueError, match="positive"):
        RayCaster({identity: ball(1.0)}, ahead(), find_backend("scalar"))


def test_frames_past_the_end_are_refused(backend: Backend) -> None:
    caster = RayCaster(crowd(frames=4), tripod(), backend)
    with pytest.raises(IndexError):
        caster.cast(4)
