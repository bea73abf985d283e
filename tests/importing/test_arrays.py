"""Depth arrays of NumPy and MATLAB give back what was put in, with the camera that lies beside them."""

import sys
import zipfile
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from imports import FRAMES, HEIGHT, KNOWN, TIMES, WIDTH, assert_depths, depth_m, depth_mm, imported, refusal
from scipy.io import savemat

from importing.calibration import Calibration

K = np.array([[300.0, 0, 3.5], [0, 310.0, 2.0], [0, 0, 1]])
BESIDE: dict[str, Any] = {"K": K, "timestamps": np.array(TIMES)}


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_an_archive_says_all_that_is_needed(tmp_path: Path, save: Any) -> None:
    save(tmp_path / "a.npz", depth=depth_mm(), **BESIDE)
    recording = imported(tmp_path / "a.npz", tmp_path / "rec", known=Calibration())
    assert_depths(recording, depth_m(depth_mm()))
    camera = recording.camera
    assert (camera.fx, camera.fy, camera.cx, camera.cy) == (300.0, 310.0, 4.0, 2.5)
    assert recording.fps == 10.0
    assert recording.metadata.timestamps == TIMES


def test_options_override_what_lies_beside(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", depth=depth_mm(), fx=1.0, fy=1.0, cx=1.0, cy=1.0, fps=1.0, scale=1.0)
    assert_depths(imported(tmp_path / "a.npz", tmp_path / "rec", known=KNOWN), depth_m(depth_mm()) * 1000)
    known = KNOWN.model_copy(update={"scale": 0.002})
    recording = imported(tmp_path / "a.npz", tmp_path / "rec2", known=known)
    assert_depths(recording, depth_m(depth_mm()) * 2)
    assert (recording.camera.fx, recording.fps) == (300.0, 15.0)


@pytest.mark.parametrize("kind", [np.float32, np.float64, np.int32])
@pytest.mark.parametrize("order", ["C", "F"])
def test_any_numbers_in_any_order(tmp_path: Path, kind: type, order: str) -> None:
    values = depth_mm() if kind is np.int32 else depth_m(depth_mm())
    np.save(tmp_path / "a.npy", np.asarray(values, dtype=kind, order=order))  # type: ignore[call-overload]
    assert_depths(imported(tmp_path / "a.npy", tmp_path / "rec"), depth_m(depth_mm()))


def test_the_only_array_is_the_depth_and_one_of_many_is_named(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", whatever=depth_mm())
    assert_depths(imported(tmp_path / "a.npz", tmp_path / "rec"), depth_m(depth_mm()))
    np.savez(tmp_path / "b.npz", left=depth_mm(), right=depth_mm(2))
    assert "got left, right: say which it is by --key NAME" in refusal(tmp_path / "b.npz", tmp_path / "rec2")
    assert imported(tmp_path / "b.npz", tmp_path / "rec3", key="right").metadata.frames == 2
    assert "expected an array 'middle', got left, right" in refusal(tmp_path / "b.npz", tmp_path / "rec4", key="middle")


def test_one_image_is_one_frame(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", depth_mm()[0])
    assert imported(tmp_path / "a.npy", tmp_path / "rec").metadata.frames == 1


def test_no_archive_and_no_numbers_are_refused(tmp_path: Path) -> None:
    for name in ("a.npz", "a.npy"):
        for content in (b"", b"hello", b"\x93NUMPY\x01\x00"):
            (tmp_path / name).write_bytes(content)
            assert f"{name}: expected arrays of numbers as NumPy saves them" in refusal(
                tmp_path / name, tmp_path / "rec"
            )
    np.save(tmp_path / "words.npy", np.full((2, 3, 4), "a"))
    assert "expected numbers, got <U1" in refusal(tmp_path / "words.npy", tmp_path / "rec")
    np.save(tmp_path / "flat.npy", np.ones(5))
    assert "expected depth of shape (frame, row, column), got (5,)" in refusal(tmp_path / "flat.npy", tmp_path / "rec")


def test_pickles_are_never_read(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", depth=np.array([{"a": 1}], dtype=object))
    assert "Python objects, which are never read" in refusal(tmp_path / "a.npz", tmp_path / "rec")
    np.savez(tmp_path / "b.npz", depth=depth_mm(), fps=np.array([{"a": 1}], dtype=object))
    assert "expected arrays of numbers" in refusal(tmp_path / "b.npz", tmp_path / "rec")


def test_a_truncated_array_is_refused_before_anything_is_made(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", depth_mm())
    content = (tmp_path / "a.npy").read_bytes()
    (tmp_path / "a.npy").write_bytes(content[:-50])
    assert "the file is not complete" in refusal(tmp_path / "a.npy", tmp_path / "rec")


def test_a_damaged_member_is_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", depth=depth_mm())
    content = bytearray((tmp_path / "a.npz").read_bytes())
    content[len(content) // 2] ^= 255
    (tmp_path / "a.npz").write_bytes(content)
    assert "Bad CRC-32" in refusal(tmp_path / "a.npz", tmp_path / "rec")


def test_an_archive_of_other_things_is_refused(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("readme.txt", "hello")
    assert "a.npz: expected" in refusal(tmp_path / "a.npz", tmp_path / "rec")


def test_times_and_matrices_of_another_size_are_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", depth=depth_mm(), timestamps=np.arange(7))
    assert f"expected {FRAMES} time stamps, one a frame, got 7" in refusal(tmp_path / "a.npz", tmp_path / "rec")
    np.savez(tmp_path / "b.npz", depth=depth_mm(), K=np.eye(4))
    assert "expected a 3x3 camera matrix, got shape (4, 4)" in refusal(tmp_path / "b.npz", tmp_path / "rec")


def rows_first(depth: np.ndarray) -> np.ndarray:
    """As MATLAB has it: (row, column, frame)."""
    return np.moveaxis(depth, 0, -1)


def save_hdf5(path: Path, **arrays: Any) -> None:
    """A MATLAB file of version 7.3 as MATLAB writes it: a text block before HDF5, and every array's sides reversed."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in arrays.items():
            stored = file.create_dataset(name, data=np.atleast_2d(value).T)
            stored.attrs["MATLAB_class"] = np.bytes_(str(np.asarray(value).dtype))
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")


@pytest.mark.parametrize("save", [lambda path, **arrays: savemat(path, arrays), save_hdf5])
def test_a_matlab_file_of_either_kind(tmp_path: Path, save: Any) -> None:
    save(tmp_path / "a.mat", depth=rows_first(depth_mm()), fx=300.0, fy=310.0, cx=3.5, cy=2.0, timestamps=TIMES)
    recording = imported(tmp_path / "a.mat", tmp_path / "rec", known=Calibration())
    assert_depths(recording, depth_m(depth_mm()))
    assert (recording.camera.height, recording.camera.width, recording.camera.fy) == (HEIGHT, WIDTH, 310.0)
    assert recording.metadata.timestamps == TIMES


@pytest.mark.parametrize("save", [lambda path, **arrays: savemat(path, arrays), save_hdf5])
def test_a_single_matlab_image_with_a_matrix(tmp_path: Path, save: Any) -> None:
    save(tmp_path / "a.mat", depth=depth_mm()[0], K=K)
    recording = imported(tmp_path / "a.mat", tmp_path / "rec", known=Calibration(fps=5.0))
    assert_depths(recording, depth_m(depth_mm())[:1])
    assert recording.camera.cx == 4.0


def test_no_matlab_file_is_refused(tmp_path: Path) -> None:
    for content in (b"", b"hello", b"MATLAB 7.3 MAT-file and no more"):
        (tmp_path / "a.mat").write_bytes(content)
        assert "a.mat: expected a MATLAB file" in refusal(tmp_path / "a.mat", tmp_path / "rec")
    savemat(tmp_path / "b.mat", {"depth": np.ones((2, 2, 2, 2))})
    assert "b.mat: expected depth of shape" in refusal(tmp_path / "b.mat", tmp_path / "rec")


def test_a_truncated_matlab_file_is_refused(tmp_path: Path) -> None:
    savemat(tmp_path / "a.mat", {"depth": rows_first(depth_mm())})
    content = (tmp_path / "a.mat").read_bytes()
    (tmp_path / "a.mat").write_bytes(content[: len(content) // 2])
    assert "a.mat: expected a" in refusal(tmp_path / "a.mat", tmp_path / "rec")


def test_a_missing_reader_says_how_to_get_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    save_hdf5(tmp_path / "a.mat", depth=rows_first(depth_mm()))
    monkeypatch.setitem(sys.modules, "h5py", None)
    message = refusal(tmp_path / "a.mat", tmp_path / "rec")
    assert "expected the package h5py, which is not installed: run pip install 'unocclude[matlab]'" in message
