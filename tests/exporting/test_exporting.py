"""Exports: what is written reads back, with other people's readers where there are any, as what was exported."""

import configparser
import json
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
import rerun.chunk
import trimesh
from billboards import BOARD, FPS, FRAMES, PASSING, squares, true_motions
from pxr import Usd, UsdGeom
from trackeval.datasets import MotChallenge2DBox

import unocclude
from exporting.export import ABOUT, FormatName, export
from recording.errors import InputError
from recording.motions import NOISE, Motions
from recording.palette import COLOURS, FAINT, rgb
from recording.recording import Recording, stripped

FORMATS: tuple[FormatName, ...] = ("ply", "tapvid3d", "mot", "usd", "rerun")


@pytest.fixture(scope="module")
def recording() -> Recording:
    return squares()


@pytest.fixture(scope="module")
def motions(recording: Recording) -> Motions:
    return true_motions(recording)


@pytest.fixture(scope="module")
def exported(
    recording: Recording, motions: Motions, tmp_path_factory: pytest.TempPathFactory
) -> Callable[[FormatName], Path]:
    """The folder of a format, made when it is first asked for."""
    place = tmp_path_factory.mktemp("exports")

    def folder(name: FormatName) -> Path:
        if not (place / name).is_dir():
            export(recording, motions, folder=place / name, format=name)
        return place / name

    return folder


Exported = Callable[[FormatName], Path]


@pytest.mark.parametrize("name", FORMATS)
def test_every_export_says_what_it_was_made_from(exported: Exported, recording: Recording, name: FormatName) -> None:
    about = json.loads((exported(name) / ABOUT).read_text(encoding="utf-8"))
    assert about["format"] == {"name": "unocclude-export", "kind": name}
    assert about["recording"]["digest"] == recording.digest()
    assert about["motions"]["version"] == "0.1.0"


# PLY


def test_trimesh_reads_every_point_of_a_frame_with_its_colour_and_marks(exported: Exported, motions: Motions) -> None:
    assert len(list(exported("ply").glob("*.ply"))) == FRAMES
    for frame in range(FRAMES):
        cloud = trimesh.load(exported("ply") / f"{frame:06d}.ply")
        rows = motions.rows(motions.frame == frame)
        np.testing.assert_array_equal(cloud.vertices, rows.position)
        assert {tuple(shade[:3]) for shade in cloud.colors.tolist()} == {tuple(rgb(COLOURS[0]))}
        vertices = cloud.metadata["_ply_raw"]["vertex"]["data"]
        np.testing.assert_array_equal(vertices["completed"].ravel(), ~rows.observed)
        np.testing.assert_array_equal(vertices["trajectory"].ravel(), rows.trajectory)
        np.testing.assert_array_equal(vertices["confidence"].ravel(), rows.confidence)


def test_noise_is_faint_and_a_frame_without_points_is_an_empty_cloud(
    recording: Recording, motions: Motions, tmp_path: Path
) -> None:
    first = motions.rows(motions.frame == 0)
    columns = {name: getattr(first, name) for name in vars(first) if name != "motion"}
    export(
        recording, Motions(**columns, motion=np.full(len(first), NOISE, np.int32)), folder=tmp_path / "o", format="ply"
    )
    assert set(map(tuple, trimesh.load(tmp_path / "o" / "000000.ply").colors[:, :3].tolist())) == {tuple(rgb(FAINT))}
    assert b"element vertex 0\n" in (tmp_path / "o" / "000001.ply").read_bytes()


# TAPVid-3D


def archive(folder: Path) -> dict[str, np.ndarray]:
    with np.load(folder / "two_squares.npz", allow_pickle=False) as arrays:
        return dict(arrays)


def test_perfect_motions_have_the_true_tracks(exported: Exported) -> None:
    found, truth = archive(exported("tapvid3d") / "found"), archive(exported("tapvid3d") / "truth")
    np.testing.assert_allclose(found["tracks_XYZ"], truth["tracks_XYZ"], atol=1e-5)
    np.testing.assert_array_equal(found["visibility"], truth["visibility"])
    np.testing.assert_array_equal(found["queries_xyt"], truth["queries_xyt"])
    assert 0 < found["visibility"].mean() < 1
    assert set(found["motion"]) == {0}
    assert set(truth["objectid"]) == {PASSING}


def test_tracks_pass_through_their_queries(exported: Exported, recording: Recording) -> None:
    truth = archive(exported("tapvid3d") / "truth")
    column, row, frame = truth["queries_xyt"].T
    fx, fy, cx, cy = truth["fx_fy_cx_cy"]
    x, y, z = truth["tracks_XYZ"][frame.astype(int), np.arange(len(frame))].T
    np.testing.assert_allclose([x / z * fx + cx, y / z * fy + cy], [column, row], atol=1e-4)
    assert truth["visibility"][frame.astype(int), np.arange(len(frame))].all()
    np.testing.assert_allclose(
        truth["extrinsics_w2c"] @ recording.camera.world_from_camera, np.tile(np.eye(4), (FRAMES, 1, 1)), atol=1e-12
    )


def test_pictures_are_jpeg_of_the_recording_s_size(exported: Exported, recording: Recording) -> None:
    pictures = archive(exported("tapvid3d") / "found")["images_jpeg_bytes"]
    shapes = {cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_COLOR).shape for picture in pictures}
    assert (len(pictures), shapes) == (FRAMES, {(recording.camera.height, recording.camera.width, 3)})


def test_without_motions_the_truth_alone_gives_tracks_of_what_moves(recording: Recording, tmp_path: Path) -> None:
    export(recording, folder=tmp_path / "o", format="tapvid3d")
    truth = archive(tmp_path / "o" / "truth")
    assert not (tmp_path / "o" / "found").exists()
    assert set(truth["objectid"]) == {PASSING}
    assert 100 < len(truth["queries_xyt"]) <= 1024
    assert len(np.unique(truth["queries_xyt"][:, 2])) > 3


def test_what_was_said_nothing_of_is_nan_and_unseen(recording: Recording, motions: Motions, tmp_path: Path) -> None:
    export(stripped(recording), motions.rows(motions.frame < 5), folder=tmp_path / "o", format="tapvid3d")
    with np.load(tmp_path / "o" / "found" / "recording.npz", allow_pickle=False) as found:
        assert np.isnan(found["tracks_XYZ"][5:]).all()
        assert not found["visibility"][5:].any()
        assert np.isfinite(found["tracks_XYZ"][:5]).all()


# MOTChallenge


def test_trackeval_reads_found_and_true_places_alike(exported: Exported) -> None:
    folder = exported("mot")
    reader = MotChallenge2DBox(
        {
            "GT_FOLDER": str(folder),
            "TRACKERS_FOLDER": str(folder.parent),
            "TRACKERS_TO_EVAL": ["mot"],
            "TRACKER_SUB_FOLDER": "",
            "BENCHMARK": "MOT15",
            "SKIP_SPLIT_FOL": True,
            "SEQ_INFO": {"two_squares": None},
            "PRINT_CONFIG": False,
        }
    )
    read = reader.get_raw_seq_data("mot", "two_squares")
    assert read["num_timesteps"] == FRAMES
    assert [ids.tolist() for ids in read["gt_ids"]] == [[PASSING]] * FRAMES
    assert [ids.tolist() for ids in read["tracker_ids"]] == [[1]] * FRAMES
    assert min(similarity.item() for similarity in read["similarity_scores"]) > 0.5


def test_places_and_confidences_come_back(exported: Exported, motions: Motions) -> None:
    found = np.loadtxt(exported("mot") / "two_squares.txt", delimiter=",")
    np.testing.assert_array_equal(found[:, 0], np.arange(1, FRAMES + 1))
    np.testing.assert_allclose(found[:, 7:], motions.representatives[0].position, atol=1e-6)
    assert (found[0, 6], found[FRAMES // 2, 6]) == (1.0, 0.75)
    about = configparser.ConfigParser()
    about.read(exported("mot") / "two_squares" / "seqinfo.ini")
    assert (about["Sequence"]["seqLength"], about["Sequence"]["frameRate"]) == (str(FRAMES), "30")


def test_true_places_are_those_that_evaluate_measures_against(exported: Exported, recording: Recording) -> None:
    truth = np.loadtxt(exported("mot") / "two_squares" / "gt" / "gt.txt", delimiter=",")
    centre = unocclude.visibility_of(recording).centre
    assert centre is not None
    np.testing.assert_allclose(truth[:, 7:], centre[0], atol=1e-6)
    depth = recording.xray[0][PASSING] if recording.xray else np.zeros((0, 0))
    row, column = np.nonzero(np.isfinite(depth))
    box = [column.min() + 1, row.min() + 1, np.ptp(column) + 1, np.ptp(row) + 1]
    np.testing.assert_array_equal(truth[0, 2:6], box)


# USD


@pytest.mark.parametrize("upright", [True, False])
def test_openusd_reads_units_axes_camera_and_truth(tmp_path: Path, upright: bool) -> None:
    recording = squares(upright=upright)
    export(recording, folder=tmp_path / "o", format="usd")
    stage = Usd.Stage.Open(str(tmp_path / "o" / "two_squares.usdc"))
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    assert UsdGeom.GetStageUpAxis(stage) == ("Z" if upright else "Y")
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode(), stage.GetTimeCodesPerSecond()) == (0, FRAMES - 1, FPS)
    camera = UsdGeom.Camera.Get(stage, "/World/Camera").GetCamera(0)
    for frame in (0, FRAMES - 1):
        mesh = UsdGeom.Mesh.Get(stage, f"/World/Truth/object_{PASSING}")
        places = np.array(mesh.GetPointsAttr().Get(frame))
        np.testing.assert_array_equal(places, recording.truth[PASSING].vertices_at(frame) if recording.truth else None)
        world = np.array(mesh.ComputeLocalToWorldTransform(frame))
        there = np.column_stack([places, np.ones(4)]) @ world
        clip = there @ np.array(camera.frustum.ComputeViewMatrix()) @ np.array(camera.frustum.ComputeProjectionMatrix())
        picture = (clip[:, :2] / clip[:, 3:] * (1, -1) + 1) / 2 * (recording.camera.width, recording.camera.height)
        np.testing.assert_allclose(picture, recording.camera.pixel_from_world(places.astype(float))[0], atol=1e-3)
    board = UsdGeom.Mesh.Get(stage, f"/World/Truth/object_{BOARD}")
    assert board.GetPointsAttr().GetNumTimeSamples() == 0


def test_openusd_reads_the_points_of_every_frame(exported: Exported, motions: Motions) -> None:
    stage = Usd.Stage.Open(str(exported("usd") / "two_squares.usdc"))
    for frame in range(FRAMES):
        for name, completed in (("observed", False), ("completed", True)):
            cloud = UsdGeom.Points.Get(stage, f"/World/Motions/motion_0/motion_0_{name}")
            rows = (motions.frame == frame) & (motions.observed != completed)
            points = np.array(cloud.GetPointsAttr().Get(frame)).reshape(-1, 3)
            np.testing.assert_array_equal(points, motions.position[rows])
    way = UsdGeom.BasisCurves.Get(stage, "/World/Motions/motion_0/motion_0_way")
    np.testing.assert_allclose(way.GetPointsAttr().Get(), motions.representatives[0].position, atol=1e-6)


# Rerun


def test_rerun_reads_depth_and_points_of_every_frame(
    exported: Exported, recording: Recording, motions: Motions
) -> None:
    points: dict[tuple[str, int], np.ndarray] = {}
    depths: dict[int, np.ndarray] = {}
    entities = set()
    for chunk in rerun.chunk.RrdReader(exported("rerun") / "two_squares.rrd").stream():
        entities.add(chunk.entity_path)
        rows = chunk.to_record_batch().to_pydict()
        for name in ("observed", "completed"):
            if chunk.entity_path == f"/world/{name}":
                for frame, places in zip(rows["frame"], rows["Points3D:positions"], strict=True):
                    points[name, frame] = np.array(places, np.float32).reshape(-1, 3)
        if chunk.entity_path == "/world/camera/depth":
            for frame, buffer in zip(rows["frame"], rows["DepthImage:buffer"], strict=True):
                depths[frame] = np.frombuffer(bytes(buffer[0]), np.float32)
    assert {f"/world/truth/{PASSING}", f"/world/truth/{BOARD}", "/world/camera", "/world/ways/0"} <= entities
    for frame in range(FRAMES):
        seen = np.nan_to_num(recording.frames[frame].depth)
        np.testing.assert_array_equal(depths[frame], seen.ravel())
        for name, completed in (("observed", False), ("completed", True)):
            rows = (motions.frame == frame) & (motions.observed != completed)
            np.testing.assert_array_equal(points[name, frame], motions.position[rows])


# What does not work


@pytest.mark.parametrize(
    ("name", "sentence"), [("ply", "expected motions"), ("mot", "expected motions"), ("usd", "got neither")]
)
def test_a_recording_alone_is_not_enough_for_every_format(tmp_path: Path, name: FormatName, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        export(stripped(squares()), folder=tmp_path / "o", format=name)
    assert list(tmp_path.iterdir()) == []


def test_motions_past_the_end_are_refused(recording: Recording, motions: Motions, tmp_path: Path) -> None:
    columns = {name: getattr(motions, name) for name in vars(motions) if name != "frame"}
    with pytest.raises(InputError, match=f"frames 0 to {FRAMES - 1}, got frame {FRAMES}"):
        export(recording, Motions(**columns, frame=motions.frame + 1), folder=tmp_path / "o", format="ply")


def test_only_an_export_is_replaced(recording: Recording, motions: Motions, tmp_path: Path) -> None:
    export(recording, motions, folder=tmp_path / "o", format="mot")
    with pytest.raises(InputError, match="--overwrite"):
        export(recording, motions, folder=tmp_path / "o", format="ply")
    export(recording, motions, folder=tmp_path / "o", format="ply", overwrite=True)
    assert not (tmp_path / "o" / "two_squares.txt").exists()
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").touch()
    with pytest.raises(InputError, match="something else"):
        export(recording, motions, folder=tmp_path / "mine", format="ply", overwrite=True)


def test_a_name_from_a_file_leads_nowhere_else(tmp_path: Path) -> None:
    export(squares(name="../../etc/ä b"), folder=tmp_path / "o", format="usd")
    assert {path.name for path in (tmp_path / "o").iterdir()} == {"______etc___b.usdc", ABOUT}
