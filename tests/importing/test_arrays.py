"""Depth arrays of NumPy and MATLAB give back what was put in, with the camera that lies beside them."""

import struct
import sys
import tracemalloc
import zipfile
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from imports import FRAMES, HEIGHT, KNOWN, TIMES, WIDTH, assert_depths, depth_m, depth_mm, imported, refusal
from scipy.io import savemat

from importing import column_major
from importing.calibration import Calibration
from importing.formats import opened
from importing.source import Wanted

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


@pytest.mark.parametrize("form", ["a.npy", "a.npz"])
def test_columns_first_are_read_block_by_block(tmp_path: Path, form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    depth = np.array(depth_mm(7), order="F")
    path = tmp_path / form
    if form == "a.npy":
        np.save(path, depth)
    else:
        np.savez_compressed(path, depth)
    monkeypatch.setattr(column_major, "BLOCK_BYTES", 3 * depth[0].nbytes + 1)
    monkeypatch.setattr(column_major, "_CHUNK_BYTES", 5 * 7 * 2)
    assert_depths(imported(path, tmp_path / "rec"), depth_m(depth_mm(7)))


def saved_large(path: Path, form: str) -> np.ndarray:
    """100 frames of 320x240 in one of the forms in which an array may come."""
    depth = np.random.default_rng(0).integers(500, 5000, (100, 240, 320), np.uint16)
    order = np.array(depth, order="F" if form.startswith("columns") else "C")
    if form.endswith(".npy"):
        np.save(path, order)
    elif form.endswith(".npz"):
        np.savez_compressed(path, depth=order)
    else:
        save = {"plain.mat": save_plain, "deflated.mat": save_deflated, "hdf5.mat": save_hdf5}[form]
        save(path, depth=rows_first(depth))
    return depth


FORMS = ["rows.npy", "columns.npy", "rows.npz", "columns.npz", "plain.mat", "deflated.mat", "hdf5.mat"]


@pytest.mark.parametrize("form", FORMS)
def test_no_array_is_held_whole(tmp_path: Path, form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    depth = saved_large(tmp_path / form, form)
    monkeypatch.setattr(column_major, "BLOCK_BYTES", 2_000_000)
    monkeypatch.setattr(column_major, "_CHUNK_BYTES", 500_000)
    tracemalloc.start()
    try:
        found = opened(tmp_path / form, Wanted())
        means = [float(frame.depth.mean()) for frame in found.frames()]
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    np.testing.assert_allclose(means, depth.mean(axis=(1, 2)) / 1000, rtol=1e-5)
    assert peak < depth.nbytes / 2


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


def save_plain(path: Path, **arrays: Any) -> None:
    """A MATLAB file of version 6."""
    savemat(path, arrays)


def save_deflated(path: Path, **arrays: Any) -> None:
    """A MATLAB file of version 7."""
    savemat(path, arrays, do_compression=True)


@pytest.mark.parametrize("save", [save_plain, save_deflated, save_hdf5])
def test_a_matlab_file_of_either_kind(tmp_path: Path, save: Any) -> None:
    save(tmp_path / "a.mat", depth=rows_first(depth_mm()), fx=300.0, fy=310.0, cx=3.5, cy=2.0, timestamps=TIMES)
    recording = imported(tmp_path / "a.mat", tmp_path / "rec", known=Calibration())
    assert_depths(recording, depth_m(depth_mm()))
    assert (recording.camera.height, recording.camera.width, recording.camera.fy) == (HEIGHT, WIDTH, 310.0)
    assert recording.metadata.timestamps == TIMES


@pytest.mark.parametrize("save", [save_plain, save_deflated, save_hdf5])
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


def test_numbers_that_lie_smaller_than_they_are_meant(tmp_path: Path) -> None:
    """MATLAB writes whole numbers of class double as 16-bit ones; their class says that they are metres."""
    save_plain(tmp_path / "a.mat", depth=np.array([[3, 4, 0], [5, 6, 7]], np.uint16))
    content = bytearray((tmp_path / "a.mat").read_bytes())
    (flags,) = struct.unpack_from("<I", content, 144)
    struct.pack_into("<I", content, 144, flags & ~255 | 6)
    (tmp_path / "a.mat").write_bytes(content)
    expected = np.array([[[3, 4, np.nan], [5, 6, 7]]], np.float32)
    assert_depths(imported(tmp_path / "a.mat", tmp_path / "rec", known=KNOWN), expected)


def test_a_matlab_file_of_the_other_byte_order(tmp_path: Path) -> None:
    depth = rows_first(depth_mm())
    elements = [
        struct.pack(">4I", 6, 8, 11, 0),
        struct.pack(">2I3iI", 5, 12, *depth.shape, 0),
        struct.pack(">2I8s", 1, 5, b"depth"),
        struct.pack(">2I", 4, depth.nbytes) + depth.astype(">u2").tobytes(order="F"),
    ]
    array = b"".join(elements)
    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x01\x00MI"
    (tmp_path / "a.mat").write_bytes(head + struct.pack(">2I", 14, len(array)) + array)
    assert_depths(imported(tmp_path / "a.mat", tmp_path / "rec"), depth_m(depth_mm()))


def test_an_old_matlab_file_holds_one_image(tmp_path: Path) -> None:
    savemat(tmp_path / "a.mat", {"depth": depth_m(depth_mm())[0].astype(np.float64)}, format="4")
    assert_depths(imported(tmp_path / "a.mat", tmp_path / "rec"), depth_m(depth_mm())[:1])


def test_complex_numbers_are_no_depth(tmp_path: Path) -> None:
    save_plain(tmp_path / "a.mat", depth=np.full((2, 3), 1j))
    assert "no real numbers" in refusal(tmp_path / "a.mat", tmp_path / "rec")


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
