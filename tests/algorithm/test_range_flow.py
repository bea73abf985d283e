"""Range flow: known motions of surfaces, none, both ways, and the loops against plain NumPy."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from worlds import Surface, box, depths_of, plane, small_camera, sphere

from algorithm.depth_image import nearness_image, smoothed_depth
from algorithm.range_energy import _relax
from algorithm.range_flow import View, agreed, range_flow
from algorithm.sampling import on_surface
from recording.camera import pixel_grid

CAMERA = small_camera(96, 72)


def views_of(surface: Surface, frames: int = 2) -> list[View]:
    depths, _ = depths_of([surface], CAMERA, frames)
    return [view_of(depth) for depth in depths]


def view_of(depth: np.ndarray) -> View:
    return View(
        surface=smoothed_depth(depth, similar_depth_m=0.1),
        image=nearness_image(depth, within=(1.0, 5.0)),
    )


def bumpy(centre: Callable[[int], tuple[float, float, float]]) -> Surface:
    """A ball with bumps, so that its turning and its moving can be told apart."""

    def depth(rays: np.ndarray, frame: int) -> np.ndarray:
        middles = np.add(centre(frame), OFFSETS).tolist()
        return np.min([sphere(lambda _, middle=middle: middle, 0.22)(rays, frame) for middle in middles], axis=0)

    return depth


OFFSETS = np.random.default_rng(3).uniform(-0.35, 0.35, size=(12, 3))


@pytest.mark.parametrize("step", [(0.05, 0.0, 0.0), (0.0, -0.04, 0.0), (0.0, 0.0, 0.06), (-0.03, 0.02, -0.05)], ids=str)
def test_a_surface_is_followed_in_picture_and_depth(step: tuple[float, float, float]) -> None:
    a, b = views_of(bumpy(lambda frame: (0.1 + step[0] * frame, step[1] * frame, 3.0 + step[2] * frame)))
    flow = range_flow(a, b)
    depth = a.surface.astype(np.float64)
    point = CAMERA.camera_from_pixel(pixel_grid(72, 96), depth)
    moved, _ = CAMERA.pixel_from_world(point + np.array(step))
    miss = np.linalg.norm(flow.column_row - (moved - pixel_grid(72, 96)), axis=-1)[np.isfinite(depth)]
    assert np.median(miss) < 0.15
    assert np.percentile(miss, 90) < 0.6
    assert np.nanmedian(np.abs(flow.depth - step[2])) < 0.006


def test_a_turning_box_is_followed() -> None:
    turn = np.radians(3.0)
    a, b = views_of(box(lambda _: (0.0, 0.0, 3.0), (0.5, 0.5, 0.5), lambda frame: 0.6 + turn * frame))
    flow = range_flow(a, b)
    point = CAMERA.camera_from_pixel(pixel_grid(72, 96), a.surface.astype(np.float64)) - np.array([0.0, 0.0, 3.0])
    turned = np.stack(
        [
            np.cos(turn) * point[..., 0] + np.sin(turn) * point[..., 2],
            point[..., 1],
            np.cos(turn) * point[..., 2] - np.sin(turn) * point[..., 0],
        ],
        axis=-1,
    )
    inner = np.isfinite(a.surface)
    assert np.nanmedian(np.abs(flow.depth - (turned - point)[..., 2])[inner]) < 0.006


@pytest.mark.parametrize("surface", [plane(lambda _: 3.0), bumpy(lambda _: (0.0, 0.0, 3.0))])
def test_no_motion_is_exactly_zero(surface: Surface) -> None:
    a, b = views_of(surface)
    flow = range_flow(a, b)
    assert not flow.column_row.any()
    np.testing.assert_array_equal(np.isfinite(flow.depth), np.isfinite(a.surface))
    assert not np.nan_to_num(flow.depth).any()


def test_there_and_back_cancel() -> None:
    a, b = views_of(bumpy(lambda frame: (0.04 * frame, 0.0, 3.0 + 0.04 * frame)))
    forward, backward = range_flow(a, b), range_flow(b, a)
    mean = agreed(forward, backward, a, b)
    known = np.isfinite(a.surface)
    row, column = np.nonzero(known)
    missed = [
        mean.column_row[i, j]
        + [
            on_surface(
                np.ascontiguousarray(backward.column_row[..., c]),
                b.surface,
                (i + mean.column_row[i, j, 1], j + mean.column_row[i, j, 0]),
                a.surface[i, j] + mean.depth[i, j],
                0.1,
            )
            for c in (0, 1)
        ]
        for i, j in zip(row, column, strict=True)
    ]
    assert np.nanmedian(np.linalg.norm(missed, axis=1)) < 0.1


@pytest.mark.parametrize("shape", [(72, 96), (1, 1), (2, 50)])
def test_empty_frames_have_no_flow(shape: tuple[int, int]) -> None:
    nothing = View(surface=np.full(shape, np.nan, np.float32), image=np.zeros(shape, np.uint8))
    something = View(surface=np.full(shape, 2.0, np.float32), image=np.full(shape, 250, np.uint8))
    for a, b in ((nothing, nothing), (nothing, something), (something, nothing)):
        flow = range_flow(a, b)
        assert flow.column_row.dtype == flow.depth.dtype == np.float32
        assert np.isfinite(flow.column_row).all()
        np.testing.assert_array_equal(np.isfinite(flow.depth), np.isfinite(a.surface))


def test_an_object_of_one_pixel_has_a_finite_flow() -> None:
    depth = np.full((72, 96), np.nan, np.float32)
    one, other = depth.copy(), depth.copy()
    one[30, 40], other[30, 42] = 3.0, 3.0
    flow = range_flow(view_of(one), view_of(other))
    assert np.isfinite(flow.depth[30, 40])
    assert np.isfinite(flow.column_row).all()


def test_the_aspects_of_a_ramp_are_its_brightness_and_its_slopes() -> None:
    row, column = np.mgrid[:20, :30]
    view = View(surface=np.full((20, 30), 2.0, np.float32), image=(2 * column + 3 * row + 60).astype(np.uint8))
    inside = 255 * view.aspects[6:-6, 6:-6]
    np.testing.assert_allclose(inside[..., 0], (2 * column + 3 * row + 60)[6:-6, 6:-6], atol=1e-6)
    np.testing.assert_allclose(
        inside[..., 1:], np.broadcast_to([2, 3, 2, 0, 0, 3, 0, 0], inside[..., 1:].shape), atol=1e-6
    )


def test_relaxation_solves_what_a_dense_solver_solves() -> None:
    """Some pixels of a row are at rest: they hold their neighbours and stay as they are."""
    generator = np.random.default_rng(5)
    count, active = 12, np.array([1, 2, 3, 5, 6, 7, 8, 10])
    half = generator.normal(size=(count, 3, 3))
    data, right = half @ half.transpose(0, 2, 1), generator.normal(size=(count, 3))
    start = generator.normal(size=(count, 3))
    chain, axes = np.arange(count), np.arange(3)
    neighbours = np.stack([np.minimum(chain + 1, count - 1), np.maximum(chain - 1, 0), chain, chain], axis=1)
    hold = np.where(neighbours != chain[:, None], generator.uniform(0.1, 2.0), 0.0)
    matrix = data[:, [0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]
    flow = start.copy()
    for _ in range(60):
        _relax(matrix[active], right[active], neighbours, hold[active], active, flow)
    whole, side = np.zeros((count, 3, count, 3)), right.copy()
    for k in range(count):
        whole[k, :, k, :] += data[k] + hold[k].sum() * np.eye(3)
        for q, other in zip(hold[k], neighbours[k], strict=True):
            whole[k, :, other, :] -= q * np.eye(3)
    rest = np.setdiff1d(chain, active)
    side[active] -= np.einsum("aibj,bj->ai", whole[np.ix_(active, axes, rest, axes)], start[rest])
    part = whole[np.ix_(active, axes, active, axes)].reshape(3 * len(active), -1)
    expected = start.copy()
    expected[active] = np.linalg.solve(part, side[active].ravel()).reshape(-1, 3)
    np.testing.assert_allclose(flow, expected, atol=1e-4)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**31),
    row=st.floats(-2, 7, allow_nan=False),
    column=st.floats(-2, 8, allow_nan=False),
)
def test_sampling_a_surface_is_bilinear_over_its_own_pixels(seed: int, row: float, column: float) -> None:
    generator = np.random.default_rng(seed)
    depth = np.where(generator.uniform(size=(6, 7)) < 0.3, 5.0, 2.0) + generator.normal(scale=0.01, size=(6, 7))
    depth[generator.uniform(size=(6, 7)) < 0.2] = np.nan
    image = generator.normal(size=(6, 7))
    total = value = 0.0
    for i in range(6):
        for j in range(7):
            weight = max(0.0, 1 - abs(i - row)) * max(0.0, 1 - abs(j - column))
            if weight and abs(depth[i, j] - 2.0) <= 0.1:
                total, value = total + weight, value + weight * image[i, j]
    assume(abs(total - 0.2) > 1e-9)  # The last digit decides, and sums differ in it.
    expected = value / total if total >= 0.2 else np.nan
    np.testing.assert_allclose(on_surface(image, depth, (row, column), 2.0, 0.1), expected, atol=1e-9)
