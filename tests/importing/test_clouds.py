"""Point clouds become depth images by the paper's projection: no pixel holds two points."""

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pypcd4
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from imports import imported, refusal

from importing.calibration import Calibration
from importing.cloud_files import cloud
from importing.scanner_plane import depth_of, scanner_camera
from recording.camera import Camera
from recording.errors import InputError

FPS = Calibration(fps=10.0)
CAMERA = Camera(width=40, height=30, fx=50.0, fy=50.0, cx=20.0, cy=15.0)


def depths(frames: int = 3) -> np.ndarray:
    """Slanted, with a hole, and something that comes nearer; a pixel at each corner of the picture."""
    row, column = np.indices((CAMERA.height, CAMERA.width))
    depth = np.stack([2 + 0.03 * row + 0.02 * column] * frames).astype(np.float32)
    for frame in range(frames):
        depth[frame, 10:20, 5 + frame : 12 + frame] = 1.5 - 0.1 * frame
    depth[:, 4:8, 25:30] = np.nan
    return depth


def points_of(depth: np.ndarray) -> np.ndarray:
    points = CAMERA.world_points(depth).reshape(-1, 3)
    return points[np.isfinite(points).all(axis=1)]


def save_ply(path: Path, points: np.ndarray) -> None:
    trimesh.PointCloud(points).export(path)


def save_ascii_ply(path: Path, points: np.ndarray) -> None:
    rows = "\n".join(f"{x:.9g} {y:.9g} {z:.9g} 255 0 0" for x, y, z in points)
    header = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex {}\nproperty float x\nproperty float y\n"
    header += "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
    path.write_text(header.format(len(points)) + rows + "\n", encoding="utf-8")


def save_pcd(encoding: pypcd4.Encoding) -> Callable[[Path, np.ndarray], None]:
    def save(path: Path, points: np.ndarray) -> None:
        rows = np.column_stack([points, np.ones(len(points))]).astype(np.float32)
        pypcd4.PointCloud.from_xyzi_points(rows).save(path, encoding=encoding)

    return save


def save_text(separator: str) -> Callable[[Path, np.ndarray], None]:
    def save(path: Path, points: np.ndarray) -> None:
        np.savetxt(path, np.column_stack([points, points]), delimiter=separator, header="x y z r g b")

    return save


SAVERS: dict[str, tuple[str, Callable[[Path, np.ndarray], None]]] = {
    "binary PLY": ("ply", save_ply),
    "text PLY": ("ply", save_ascii_ply),
    "text PCD": ("pcd", save_pcd(pypcd4.Encoding.ASCII)),
    "binary PCD": ("pcd", save_pcd(pypcd4.Encoding.BINARY)),
    "compressed PCD": ("pcd", save_pcd(pypcd4.Encoding.BINARY_COMPRESSED)),
    "XYZ": ("xyz", save_text(" ")),
    "CSV": ("csv", save_text(",")),
    "NPY": ("npy", np.save),
}


@pytest.mark.parametrize("what", SAVERS)
def test_a_grid_of_rays_comes_back_from_every_kind_of_file(tmp_path: Path, what: str) -> None:
    suffix, save = SAVERS[what]
    (tmp_path / "clouds").mkdir()
    for number, depth in enumerate(depths()):
        save(tmp_path / "clouds" / f"{number}.{suffix}", points_of(depth))
    recording = imported(tmp_path / "clouds", tmp_path / "rec", known=FPS)
    assert recording.camera.fx == recording.camera.fy == pytest.approx(CAMERA.fx, rel=1e-4)
    for frame, depth in zip(recording.frames, depths(), strict=True):
        found = frame.depth[:30, :40]
        np.testing.assert_array_equal(np.isnan(found), np.isnan(depth))
        np.testing.assert_allclose(found, depth, rtol=1e-5)
        assert np.isnan(frame.depth).sum() == frame.depth.size - np.isfinite(depth).sum()
    seen = recording.camera.world_points(recording.frames[0].depth)
    places = seen[np.isfinite(seen).all(axis=-1)]
    np.testing.assert_allclose(places, points_of(depths()[0]), atol=2e-3)  # Row by row, in the pixels' order.


def test_an_organised_cloud_leaves_out_what_is_not_finite(tmp_path: Path) -> None:
    (tmp_path / "clouds").mkdir()
    np.save(tmp_path / "clouds" / "0.npy", CAMERA.world_points(depths()[0]))
    frame = imported(tmp_path / "clouds", tmp_path / "rec", known=FPS).frames[0]
    assert frame.seen.sum() == np.isfinite(depths()[0]).sum()


@given(st.integers(0, 2**32 - 1), st.integers(2, 60))
def test_no_pixel_holds_two_points(seed: int, count: int) -> None:
    generator = np.random.default_rng(seed)
    grid = generator.permutation(np.argwhere(np.ones((8, 8))))[:count]
    plane = (grid + generator.uniform(-0.49, 0.49, (count, 2))) / 10
    depth = generator.uniform(0.5, 5, count)
    clouds = [np.column_stack([plane * depth[:, None], depth])]
    camera = scanner_camera(clouds, np.eye(4), source="test")
    image = depth_of(clouds[0], camera)
    np.testing.assert_array_equal(np.sort(image[np.isfinite(image)]), np.sort(depth.astype(np.float32)))


def test_the_smallest_distance_of_all_frames_decides() -> None:
    wide = np.array([[0.0, 0, 1], [0.1, 0, 1]])
    near = np.array([[0.0, 0, 2], [0.04, 0, 2]])  # 0.02 apart on the plane.
    assert scanner_camera([wide, near], np.eye(4), source="test").fx == pytest.approx(50, rel=1e-4)
    assert scanner_camera([wide], np.eye(4), source="test").fx == pytest.approx(10, rel=1e-4)


def test_of_a_scanner_that_is_known_the_nearest_point_is_taken(tmp_path: Path) -> None:
    (tmp_path / "clouds").mkdir()
    np.save(tmp_path / "clouds" / "0.npy", np.array([[0.0, 0, 2], [0.001, 0, 1.5], [0, 0, -1], [9, 0, 1]]))
    known = Calibration(fx=50.0, fy=50.0, cx=20.0, cy=15.0, width=40, height=30, fps=10.0, pixel_centre=0.5)
    recording = imported(tmp_path / "clouds", tmp_path / "rec", known=known)
    assert (recording.camera.cx, recording.camera.width) == (20.0, 40)
    depth = recording.frames[0].depth
    assert depth[15, 20] == pytest.approx(1.5)
    assert np.isfinite(depth).sum() == 1
    assert "pass --size WxH" in refusal(
        tmp_path / "clouds", tmp_path / "rec2", known=known.model_copy(update={"width": None})
    )


@pytest.mark.parametrize("axes", ["opencv", "opengl", "ros"])
def test_the_points_own_axes_are_the_worlds(tmp_path: Path, axes: str) -> None:
    seen = points_of(depths()[0])
    turned = {"opencv": seen, "opengl": seen * [1, -1, -1], "ros": seen[:, [2, 0, 1]] * [1, -1, -1]}[axes]
    (tmp_path / "clouds").mkdir()
    np.save(tmp_path / "clouds" / "0.npy", turned)
    recording = imported(tmp_path / "clouds", tmp_path / "rec", known=FPS, axes=axes)
    np.testing.assert_allclose(recording.frames[0].depth[:30, :40], depths()[0], rtol=1e-5)
    world = recording.camera.world_points(recording.frames[0].depth)
    np.testing.assert_allclose(world[np.isfinite(world).all(axis=-1)], turned, atol=2e-3)


def test_points_in_a_world_with_the_scanners_place(tmp_path: Path) -> None:
    place = ((0.0, 0.0, 1.0, 4.0), (-1.0, 0.0, 0.0, 5.0), (0.0, -1.0, 0.0, 1.5), (0.0, 0.0, 0.0, 1.0))
    matrix = np.array(place)
    (tmp_path / "clouds").mkdir()
    np.save(tmp_path / "clouds" / "0.npy", points_of(depths()[0]) @ matrix[:3, :3].T + matrix[:3, 3])
    known = Calibration(fps=10.0, world_from_camera=place)
    recording = imported(tmp_path / "clouds", tmp_path / "rec", known=known)
    np.testing.assert_allclose(recording.frames[0].depth[:30, :40], depths()[0], rtol=1e-5)
    np.testing.assert_allclose(recording.camera.world_from_camera, matrix)


def test_points_behind_the_scanner_ask_for_the_axes(tmp_path: Path) -> None:
    (tmp_path / "clouds").mkdir()
    np.save(tmp_path / "clouds" / "0.npy", points_of(depths()[0])[:, [2, 0, 1]])
    message = refusal(tmp_path / "clouds", tmp_path / "rec", known=FPS)
    assert "expected points before the scanner, at z > 0" in message
    assert "by --axes" in message


@pytest.mark.parametrize(
    ("points", "expected"),
    [
        ([[0, 0, 1], [0, 0, 2]], "two of a frame lie on one ray"),
        ([[0, 0, 1], [1e-6, 0, 1], [1, 1, 1]], "the picture would need 1e+06x1e+06 pixels"),
        ([[0, 0, 1]], "expected clouds of at least two points, got none"),
    ],
)
def test_clouds_without_a_resolution_are_refused(tmp_path: Path, points: list[list[float]], expected: str) -> None:
    (tmp_path / "clouds").mkdir()
    np.save(tmp_path / "clouds" / "0.npy", np.array(points, float))
    assert expected in refusal(tmp_path / "clouds", tmp_path / "rec", known=FPS)


@pytest.mark.parametrize("suffix", ["ply", "pcd", "xyz", "npy"])
@pytest.mark.parametrize(
    "content", [b"hello", b"ply\nformat ascii 1.0\nelement vertex 5\nend_header\n", b"\xff\xfe\x00"]
)
def test_a_damaged_cloud_is_named(tmp_path: Path, suffix: str, content: bytes) -> None:
    path = tmp_path / f"0.{suffix}"
    path.write_bytes(content)
    with pytest.raises(InputError) as refused:
        cloud(path)
    assert str(refused.value).startswith(f"{path}: expected")
    assert "\n" not in str(refused.value)


def test_text_may_begin_with_its_number_of_points_and_may_be_empty(tmp_path: Path) -> None:
    (tmp_path / "a.xyz").write_text("2\n1 2 3\n4 5 6\n", encoding="utf-8")
    np.testing.assert_array_equal(cloud(tmp_path / "a.xyz"), [[1, 2, 3], [4, 5, 6]])
    (tmp_path / "b.xyz").write_text("", encoding="utf-8")
    assert cloud(tmp_path / "b.xyz").shape == (0, 3)


def test_a_missing_reader_says_how_to_get_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pypcd4", None)
    (tmp_path / "a.pcd").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="expected the package pypcd4, which is not installed"):
        cloud(tmp_path / "a.pcd")
