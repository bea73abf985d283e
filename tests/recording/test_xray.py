"""X-rays on disk: only the rectangle that an object fills, and the whole picture back."""

from pathlib import Path

import numpy as np
import OpenEXR
import pytest

from recording.errors import InputError
from recording.exr import read_xray, write_channels, write_xray
from recording.xray import Cutout, CutoutXRay, trimmed_cutouts

SHAPE = (12, 20)


def picture(rows: slice, columns: slice) -> np.ndarray:
    depth = np.full(SHAPE, np.float32(np.nan))
    depth[rows, columns] = np.random.default_rng(1).uniform(1, 5, depth[rows, columns].shape)
    return depth


PICTURES = {
    "middle": picture(slice(3, 9), slice(4, 11)),
    "corner": picture(slice(11, 12), slice(19, 20)),
    "everywhere": picture(slice(0, 12), slice(0, 20)),
    "nowhere": picture(slice(0, 0), slice(0, 0)),
}


@pytest.mark.parametrize("kind", PICTURES)
def test_a_picture_comes_back(tmp_path: Path, kind: str) -> None:
    xray = {4: PICTURES[kind], 9: PICTURES["middle"]}
    write_xray(tmp_path / "xray.exr", xray, shape=SHAPE)
    loaded = read_xray(tmp_path / "xray.exr", shape=SHAPE)
    assert list(loaded) == [4, 9]
    for objectid, depth in xray.items():
        assert loaded[objectid].dtype == np.float32
        np.testing.assert_array_equal(loaded[objectid], depth)


def test_a_cutout_and_its_whole_picture_are_the_same_bytes(tmp_path: Path) -> None:
    depth = PICTURES["middle"]
    cutout = CutoutXRay({4: Cutout(row=2, column=1, depth=depth[2:11, 1:15])}, SHAPE)
    np.testing.assert_array_equal(cutout[4], depth)
    write_xray(tmp_path / "cutout.exr", cutout, shape=SHAPE)
    write_xray(tmp_path / "whole.exr", {4: depth}, shape=SHAPE)
    assert (tmp_path / "cutout.exr").read_bytes() == (tmp_path / "whole.exr").read_bytes()


def test_the_smallest_rectangle_is_kept() -> None:
    cutout = trimmed_cutouts({4: PICTURES["middle"]})[4]
    assert (cutout.row, cutout.column, cutout.depth.shape) == (3, 4, (6, 7))


def test_other_programs_see_where_it_lies(tmp_path: Path) -> None:
    write_xray(tmp_path / "xray.exr", {4: PICTURES["middle"]}, shape=SHAPE)
    with OpenEXR.File(str(tmp_path / "xray.exr"), separate_channels=True) as file:
        header = file.parts[0].header
        assert [place.tolist() for place in header["dataWindow"]] == [[4, 3], [10, 8]]
        assert [place.tolist() for place in header["displayWindow"]] == [[0, 0], [19, 11]]


def test_full_size_channels_of_one_part_are_read_too(tmp_path: Path) -> None:
    depth = PICTURES["middle"]
    write_channels(tmp_path / "xray.exr", {"xray_4": np.nan_to_num(depth)}, attributes={})
    np.testing.assert_array_equal(read_xray(tmp_path / "xray.exr", shape=SHAPE)[4], depth)


def test_a_part_beyond_the_picture_is_refused(tmp_path: Path) -> None:
    write_xray(tmp_path / "xray.exr", {4: PICTURES["middle"]}, shape=SHAPE)
    with pytest.raises(InputError, match=r"xray\.exr: expected parts within 10x12 pixels, got 'xray_4' in rows 3 to 8"):
        read_xray(tmp_path / "xray.exr", shape=(12, 10))
