"""Classic+NL: known motion, what is empty, and each compiled loop beside plain NumPy."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter, map_coordinates
from scipy.sparse import csr_array
from scipy.sparse.linalg import spsolve

from algorithm.classic_nl import FAST, FULL, Effort, View, classic_nl, depth_flow, photograph_flow
from algorithm.linear_flow import flow_step
from algorithm.pyramid import continued, level_shapes, pyramid, resized_flow
from algorithm.texture import structure, textures
from algorithm.warping import derivatives, warped
from algorithm.weighted_median import median_filtered

HEIGHT, WIDTH = 56, 64


def texture(seed: int = 0) -> np.ndarray:
    """A smooth random picture without an empty pixel, 20 to 235."""
    noise = gaussian_filter(np.random.default_rng(seed).normal(size=(HEIGHT, WIDTH)), 2.0)
    return (128 + 40 * noise / noise.std()).clip(20, 235)


def centred_grid() -> np.ndarray:
    """The (row, column) of every pixel from the middle of the picture."""
    return np.stack(np.mgrid[:HEIGHT, :WIDTH], axis=-1) - np.array([(HEIGHT - 1) / 2, (WIDTH - 1) / 2])


def moved(image: np.ndarray, matrix: np.ndarray, shift: tuple[float, float] = (0, 0)) -> tuple[np.ndarray, np.ndarray]:
    """The picture after p goes to matrix p + shift about its middle, and the flow (column, row) that does so."""
    grid, middle = centred_grid(), np.array([(HEIGHT - 1) / 2, (WIDTH - 1) / 2])
    came_from = (grid - np.array(shift)) @ np.linalg.inv(matrix).T + middle
    flow = grid @ matrix.T + np.array(shift) - grid
    return map_coordinates(image, np.moveaxis(came_from, -1, 0), order=3, mode="nearest").clip(1, 255), flow[..., ::-1]


def as_depth(image: np.ndarray) -> np.ndarray:
    return np.rint(image).astype(np.uint8)


ANGLE = 0.04
MOTIONS = {
    "shift": (np.eye(2), (1.3, -2.4)),
    "rotation": (np.array([[np.cos(ANGLE), -np.sin(ANGLE)], [np.sin(ANGLE), np.cos(ANGLE)]]), (0.0, 0.0)),
    "approach": (1.05 * np.eye(2), (0.0, 0.0)),
}


@pytest.mark.parametrize("effort", [FULL, FAST], ids=["full", "fast"])
@pytest.mark.parametrize("motion", MOTIONS)
def test_a_known_motion_is_found(motion: str, effort: Effort) -> None:
    image = texture()
    later, truth = moved(image, *MOTIONS[motion])
    flow = depth_flow(as_depth(image), as_depth(later), effort=effort)
    error = np.linalg.norm(flow - truth, axis=-1)[8:-8, 8:-8]
    assert np.median(error) < 0.08
    assert np.percentile(error, 95) < 0.3


def test_there_and_back_are_opposite() -> None:
    image = texture()
    later, _ = moved(image, np.eye(2), (0.0, 1.6))
    there, back = (
        depth_flow(*pair, effort=FAST)
        for pair in ((as_depth(image), as_depth(later)), (as_depth(later), as_depth(image)))
    )
    np.testing.assert_allclose(np.median(there + back, axis=(0, 1)), 0, atol=0.03)


def test_mirrored_pictures_have_mirrored_flow() -> None:
    image = texture()
    later, _ = moved(image, *MOTIONS["shift"])
    a, b = as_depth(image), as_depth(later)
    flow = depth_flow(a, b, effort=FAST)
    mirrored = depth_flow(a[:, ::-1].copy(), b[:, ::-1].copy(), effort=FAST)[:, ::-1] * np.array([-1, 1])
    assert np.median(np.linalg.norm(flow - mirrored, axis=-1)) < 0.02


def test_no_motion_is_exactly_zero() -> None:
    image = as_depth(texture())
    image[:20, 30:] = 0
    assert not depth_flow(image, image, effort=FAST).any()
    colours = np.stack([image, image // 2, 255 - image], axis=-1)
    assert not photograph_flow(colours, colours, effort=FAST).any()


def test_empty_pictures_and_single_pixels_have_a_finite_flow() -> None:
    empty = np.zeros((HEIGHT, WIDTH), np.uint8)
    one, other = empty.copy(), empty.copy()
    one[20, 20], other[20, 22] = 200, 200
    assert not depth_flow(empty, empty, effort=FAST).any()
    for pair in ((empty, one), (one, empty), (one, other)):
        flow = depth_flow(*pair, effort=FAST)
        assert flow.dtype == np.float32
        assert np.isfinite(flow).all()


def test_what_is_empty_has_no_influence() -> None:
    image = texture()
    later, _ = moved(image, *MOTIONS["shift"])
    valid = np.ones((HEIGHT, WIDTH), bool)
    valid[:, 40:] = False
    valid[10:20, 10:14] = False
    flows = []
    for filling in (0, 255):
        pictures = [np.where(valid, picture, filling).astype(np.float32) for picture in (image, later)]
        images = [continued(picture, valid) for picture in pictures]
        views = [View(image=picture, valid=valid, guide=picture[..., None]) for picture in images]
        flows.append(classic_nl(*views, effort=FAST))
    np.testing.assert_array_equal(flows[0], flows[1])
    np.testing.assert_allclose(np.median(flows[0][8:-8, 8:32], axis=(0, 1)), MOTIONS["shift"][1][::-1], atol=0.1)


def test_photographs_under_changing_light_are_followed() -> None:
    image = texture()
    later, _ = moved(image, np.eye(2), (0.0, 1.5))
    shade = np.linspace(0.95, 1.05, WIDTH)
    a, b = (as_depth(picture)[..., None].repeat(3, axis=-1) for picture in (image, (later * shade).clip(0, 255)))
    flow = photograph_flow(a, b, effort=FAST)
    np.testing.assert_allclose(np.median(flow[8:-8, 8:-8], axis=(0, 1)), [1.5, 0.0], atol=0.15)


def naive_weighted_median(values: np.ndarray, weights: np.ndarray) -> float:
    order = np.argsort(values, kind="stable")
    reached = np.cumsum(weights[order].astype(np.float64))
    return values[order][np.searchsorted(reached, reached[-1] / 2)]


def test_medians_are_those_of_plain_numpy() -> None:
    generator = np.random.default_rng(3)
    height, width = 24, 30
    flow = np.where(np.arange(width)[:, None] < 14, [0.0, 0.0], [4.0, 2.0])[None].repeat(height, axis=0)
    flow = (flow + generator.normal(0, 0.1, (height, width, 2))).astype(np.float32)
    guide = generator.uniform(100, 125, (height, width, 3)).astype(np.float32)
    trust = generator.uniform(0.1, 1, (height, width)).astype(np.float32)
    valid = generator.random((height, width)) < 0.8
    found = median_filtered(flow, guide=guide, trust=trust, valid=valid)
    for row, column in ((3, 13), (12, 14), (23, 12), (0, 15)):  # At the edge of the flow.
        i, j = (slice(max(0, k - 7), k + 8) for k in (row, column))
        apart = (np.mgrid[:height, :width][0] - row) ** 2 + (np.mgrid[:height, :width][1] - column) ** 2
        unlike = ((guide - guide[row, column]) ** 2).mean(axis=-1)
        weight = np.exp(-(apart + unlike) / (2 * 7**2)) * trust * valid
        for c in range(2):
            expected = naive_weighted_median(flow[i, j, c].ravel(), weight[i, j].ravel())
            assert found[row, column, c] == pytest.approx(expected, abs=1e-6)
    for row, column in ((5, 3), (10, 25), (0, 0)):  # Far from it.
        i, j = (slice(max(0, k - 2), k + 3) for k in (row, column))
        inside = flow[i, j][valid[i, j]]
        expected = [naive_weighted_median(inside[:, c], np.ones(len(inside))) for c in range(2)]
        np.testing.assert_allclose(found[row, column], expected, atol=1e-6)


def test_nearly_equal_flows_have_a_median_between_them() -> None:
    flow = np.full((16, 16, 2), 1e-42, np.float32)
    flow[:, 8:] = 0
    ones = np.ones((16, 16), np.float32)
    found = median_filtered(flow, guide=ones[..., None], trust=ones, valid=ones > 0)
    assert ((found >= 0) & (found <= flow.max())).all()


def test_bicubic_warping_reads_cubics_exactly() -> None:
    column, row = np.meshgrid(np.arange(20.0), np.arange(16.0))

    def cubic(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return 0.01 * x**3 - 0.2 * x * y + 0.02 * y**2 * x + y

    image = cubic(column, row).astype(np.float32)
    flow = np.random.default_rng(0).uniform(-1, 1, (16, 20, 2)).astype(np.float32)
    found = warped(image, flow)[4:-4, 4:-4]
    x, y = ((grid + flow[..., k])[4:-4, 4:-4] for k, grid in enumerate((column, row)))
    slope_x, slope_y = 0.03 * x**2 - 0.2 * y + 0.02 * y**2, -0.2 * x + 0.04 * y * x + 1
    np.testing.assert_allclose(found, np.stack([cubic(x, y), slope_x, slope_y], axis=-1), atol=1e-3)
    np.testing.assert_allclose(derivatives(image)[4:-4, 4:-4], warped(image, 0 * flow)[4:-4, 4:-4, 1:], atol=1e-4)


def test_where_the_flow_leaves_the_picture_nothing_is_read() -> None:
    flow = np.zeros((8, 9, 2), np.float32)
    flow[0, 0], flow[3, 8] = (-0.5, 0), (0.1, 0)
    lost = np.isnan(warped(np.ones((8, 9), np.float32), flow)[..., 0])
    assert np.argwhere(lost).tolist() == [[0, 0], [3, 8]]


@pytest.mark.parametrize("quadratic", [1.0, 0.5])
def test_a_step_solves_the_normal_equations(quadratic: float) -> None:
    """Beside a sparse direct solver, on the equations written from the energy."""
    generator = np.random.default_rng(5)
    height, width = 9, 11
    flow = generator.normal(0, 1, (height, width, 2)).astype(np.float32)
    slopes = generator.normal(0, 3, (height, width, 3)).astype(np.float32)

    def weight(x: np.ndarray) -> np.ndarray:
        return quadratic + (1 - quadratic) * 0.45 * (x**2 + 1e-6) ** -0.55

    number = np.arange(height * width * 2).reshape(height, width, 2)
    rows, targets = [], []
    root = np.sqrt(weight(slopes[..., 2]))
    for i, j in np.ndindex(height, width):
        rows.append({number[i, j, c]: root[i, j] * slopes[i, j, c] for c in range(2)})
        targets.append(-root[i, j] * slopes[i, j, 2])
        for down, right in ((0, 1), (1, 0)):
            if i + down < height and j + right < width:
                for c in range(2):
                    difference = float(flow[i + down, j + right, c] - flow[i, j, c])
                    link = np.sqrt(3 * weight(np.array(difference)))
                    rows.append({number[i + down, j + right, c]: link, number[i, j, c]: -link})
                    targets.append(-link * difference)
    entries = [(k, column, value) for k, row in enumerate(rows) for column, value in row.items()]
    k, column, value = (np.array(part) for part in zip(*entries, strict=True))
    matrix = csr_array((value, (k, column)), shape=(len(rows), number.size))
    expected = spsolve((matrix.T @ matrix).tocsc(), matrix.T @ np.array(targets)).reshape(flow.shape)
    found = flow_step(flow, slopes, smoothness=3.0, quadratic=quadratic, sweeps=300)
    np.testing.assert_allclose(found, expected, atol=1e-5)
    found = flow_step(flow, slopes, smoothness=3.0, quadratic=quadratic)
    np.testing.assert_allclose(found, expected, atol=0.1)


def test_what_is_empty_continues_the_nearest() -> None:
    image = np.array([[5, 0, 0, 9]], np.float32)
    np.testing.assert_array_equal(continued(image, image > 0), [[5, 5, 9, 9]])
    assert not continued(image, image > 100).any()


def test_a_pyramid_halves_and_keeps_what_is_flat() -> None:
    shapes = level_shapes((40, 50), levels=3, spacing=2.0)
    assert shapes == [(40, 50), (20, 25), (10, 12)]
    for shape, level in zip(shapes, pyramid(np.full((40, 50), 7, np.float32), shapes, spacing=2.0), strict=True):
        assert level.shape == shape
        np.testing.assert_allclose(level, 7, atol=1e-5)
    flow = resized_flow(np.full((10, 12, 2), 1, np.float32), (20, 24))
    np.testing.assert_allclose(flow, 2, atol=1e-6)


def test_structure_keeps_the_mean_and_flattens_and_texture_forgets_the_light() -> None:
    generator = np.random.default_rng(7)
    fine = generator.normal(0, 0.05, (40, 40)).astype(np.float32)
    smooth = structure(fine)
    assert smooth.mean() == pytest.approx(fine.mean(), abs=1e-5)
    assert smooth.std() < 0.2 * fine.std()
    slope = np.linspace(-1, 1, 40, dtype=np.float32)
    found = textures(np.stack([4 * fine + slope, 4 * fine - slope]))
    assert (found.min(), found.max()) == (0, pytest.approx(255))
    assert np.corrcoef(found[0].ravel(), found[1].ravel())[0, 1] > 0.8
    assert not textures(np.ones((2, 5, 5), np.float32)).any()
