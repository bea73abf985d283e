"""The whole algorithm on small worlds with known answers."""

from functools import cache

import numpy as np
import pytest
from worlds import box, plane, recorded, recording_of, small_camera, sphere

from algorithm.pipeline import solve
from algorithm.settings import Settings, preset_settings
from recording.motions import COLUMNS, NOISE, Motions
from recording.recording import Recording, stripped

FRAMES = 60
CAMERA = small_camera(120, 80)
RADIUS = 0.35


def right(frame: int) -> tuple[float, float, float]:
    """The centre of the ball that goes right."""
    return -1.6 + 3.2 * frame / (FRAMES - 1), -0.25, 4.0


def left(frame: int) -> tuple[float, float, float]:
    """The centre of the ball that goes left."""
    return 1.7 - 3.4 * frame / (FRAMES - 1), 0.3, 4.8


@cache
def crossing() -> Recording:
    """Two balls that cross behind a wall in the middle of the picture."""
    wall = box(lambda _: (0.0, 0.0, 2.5), (0.35, 3.0, 0.05))
    surfaces = [sphere(right, RADIUS), sphere(left, RADIUS), wall, plane(lambda _: 7.0)]
    return recorded(surfaces, frames=FRAMES, moving=[True, True, False, False], camera=CAMERA)


@cache
def solved_crossing() -> Motions:
    return solve(crossing())


def true_objects(recording: Recording, motions: Motions) -> np.ndarray:
    """The object behind each observed row; 0 elsewhere."""
    objects = np.zeros(len(motions), int)
    for row in np.flatnonzero(motions.observed):
        labels = recording.frames[motions.frame[row]].labels
        assert labels is not None
        column, line = np.floor(motions.column_row[row]).astype(int)
        objects[row] = labels.objectid[line, column]
    return objects


def object_of(recording: Recording, motions: Motions, motion: int) -> tuple[int, float]:
    """The object that most observed rows of a motion show, and their share."""
    seen = true_objects(recording, motions)[(motions.motion == motion) & motions.observed]
    count = np.bincount(seen)
    return int(count.argmax()), float(count.max() / count.sum())


def assert_well_formed(motions: Motions, recording: Recording) -> None:
    """Sorted, no row twice, completed rows without a picture position, ids that fit together."""
    key = motions.trajectory.astype(np.int64) * 10_000 + motions.frame
    assert (np.diff(key) > 0).all()
    assert ((motions.frame >= 0) & (motions.frame < recording.metadata.frames)).all()
    assert np.isfinite(motions.position).all()
    np.testing.assert_array_equal(np.isfinite(motions.column_row).all(axis=1), motions.observed)
    assert ((motions.confidence >= 0) & (motions.confidence <= 1)).all()
    assert (motions.motion[~motions.observed] != NOISE).all()
    assert motions.motion_ids == list(range(len(motions.representatives)))
    for motion, curve in zip(motions.motion_ids, motions.representatives, strict=True):
        assert curve.motion == motion
        assert (np.diff(curve.frame) == 1).all()
        assert np.isfinite(curve.position).all()
        assert set(motions.frame[motions.motion == motion]) <= set(curve.frame)
    for trajectory in np.unique(motions.trajectory)[:200]:
        assert len(np.unique(motions.motion[motions.trajectory == trajectory])) == 1


def test_two_balls_that_cross_behind_a_wall_are_two_motions() -> None:
    motions = solved_crossing()
    assert_well_formed(motions, crossing())
    assert len(motions.motion_ids) == 2
    found = [object_of(crossing(), motions, motion) for motion in motions.motion_ids]
    assert sorted(number for number, _ in found) == [1, 2]
    assert all(purity > 0.99 for _, purity in found)
    assert len(motions.links) == 2


def test_the_completed_path_lies_near_the_truth_in_the_hole() -> None:
    motions = solved_crossing()
    for curve in motions.representatives:
        number, _ = object_of(crossing(), motions, curve.motion)
        centre = np.array([(right, left)[number - 1](frame) for frame in curve.frame])
        offset = np.median((curve.position - centre)[curve.observed], axis=0)  # A surface lies before its centre.
        miss = np.linalg.norm(curve.position - centre - offset, axis=1)
        assert (~curve.observed).sum() >= 8
        assert miss[~curve.observed].mean() < 0.15  # A ball's shading is smooth: its points slip over the surface.
        assert miss[~curve.observed].max() < 0.25
        assert np.linalg.norm(offset) < RADIUS


def test_completed_points_lie_on_the_hidden_ball() -> None:
    motions = solved_crossing()
    hidden = ~motions.observed
    assert hidden.sum() > 500
    number = np.array([object_of(crossing(), motions, motion)[0] for motion in motions.motion_ids])[motions.motion]
    centre = np.array(
        [(right, left)[which - 1](frame) for which, frame in zip(number[hidden], motions.frame[hidden], strict=True)]
    )
    away = np.abs(np.linalg.norm(motions.position[hidden] - centre, axis=1) - RADIUS)
    assert np.median(away) < 0.05
    assert np.percentile(away, 95) < 0.15


def test_observed_points_lie_on_the_surface_that_their_pixel_shows() -> None:
    motions = solved_crossing()
    for frame in (0, 20, 59):
        rows = (motions.frame == frame) & motions.observed
        column, row = np.floor(motions.column_row[rows]).astype(int).T
        seen_at, depth = CAMERA.pixel_from_world(motions.position[rows].astype(np.float64))
        np.testing.assert_allclose(seen_at, motions.column_row[rows], atol=1e-3)
        np.testing.assert_allclose(depth, crossing().frames[frame].depth[row, column], atol=0.1)


def test_pixel_to_pixel_the_observed_points_are_the_pixels_of_the_recording() -> None:
    motions = solve(crossing(), Settings(chaining="pixels"))
    for frame in (0, 20, 59):
        rows = (motions.frame == frame) & motions.observed
        column, row = np.floor(motions.column_row[rows]).astype(int).T
        points = CAMERA.world_points(crossing().frames[frame].depth)
        np.testing.assert_allclose(motions.position[rows], points[row, column], atol=1e-5)


def test_the_moving_points_are_covered_and_the_still_ones_are_not() -> None:
    motions = solved_crossing()
    objects = true_objects(crossing(), motions)
    assert (objects[motions.observed & (motions.motion != NOISE)] <= 2).mean() > 0.99
    total = sum(int((frame.labels.objectid == 1).sum()) for frame in crossing().frames if frame.labels)
    assert ((objects == 1) & (motions.motion != NOISE)).sum() > 0.7 * total


def rows_of(motions: Motions) -> list[np.ndarray]:
    return [getattr(motions, name) for name in COLUMNS]


def test_nothing_but_depth_camera_and_rate_is_read() -> None:
    bare = solve(stripped(crossing()))
    for mine, theirs in zip(rows_of(solved_crossing()), rows_of(bare), strict=True):
        np.testing.assert_array_equal(mine, theirs)
    assert bare.making.recording_digest == crossing().digest()


def test_twice_gives_the_same() -> None:
    for mine, theirs in zip(rows_of(solved_crossing()), rows_of(solve(crossing())), strict=True):
        np.testing.assert_array_equal(mine, theirs)


def test_the_result_says_how_it_was_made() -> None:
    making = solved_crossing().making
    assert making.settings == Settings().model_dump()
    stages = {"flow", "match", "trajectories", "clustering", "completion", "total"}
    assert stages <= set(making.seconds)
    assert making.seconds["total"] >= max(making.seconds[stage] for stage in stages - {"total"})


def test_a_turning_box_is_one_motion() -> None:
    turning = box(lambda t: (-1.1 + 0.055 * t, 0.0, 3.0), (0.25, 0.3, 0.25), turn=lambda t: 0.03 * t)
    recording = recorded([turning, plane(lambda _: 6.0)], frames=40, moving=[True, False])
    motions = solve(recording)
    assert_well_formed(motions, recording)
    assert motions.motion_ids == [0]
    assert object_of(recording, motions, 0)[1] > 0.99


def test_a_plate_that_moves_sideways_is_one_motion_that_goes_straight() -> None:
    """Its inside looks the same everywhere, so its points lag: 16 % of the step are allowed."""
    pixel = 2.98 / 80
    plate = box(lambda t: (-1.1 + pixel * t, 0.05, 3.0), (0.25, 0.4, 0.02))
    recording = recorded([plate, plane(lambda _: 6.0)], frames=60, moving=[True, False])
    motions = solve(recording)
    assert_well_formed(motions, recording)
    assert motions.motion_ids == [0]
    curve = motions.representatives[0]
    assert curve.observed.all()
    step = np.diff(curve.position[3:-3], axis=0).mean(axis=0)
    np.testing.assert_allclose(step, [pixel, 0, 0], atol=0.006)


def test_two_balls_apart_are_two_motions_and_never_linked() -> None:
    surfaces = [sphere(lambda t: (-0.8, -0.9 + 0.06 * t, 3.0), 0.3), sphere(lambda t: (0.8, 0.9 - 0.06 * t, 3.0), 0.3)]
    recording = recorded([*surfaces, plane(lambda _: 6.0)], frames=30, moving=[True, True, False])
    motions = solve(recording)
    assert_well_formed(motions, recording)
    assert sorted(object_of(recording, motions, motion)[0] for motion in motions.motion_ids) == [1, 2]
    assert motions.links == ()
    assert all(curve.observed.all() for curve in motions.representatives)


def test_noise_alone_makes_no_motion() -> None:
    generator = np.random.default_rng(0)
    still, _ = (recorded([plane(lambda _: 4.0)], frames=20, moving=[False]).frames, None)
    depths = [frame.depth + generator.normal(0, 0.005, frame.depth.shape).astype(np.float32) for frame in still]
    assert solve(recording_of(depths)).motion_ids == []


def flat(depth: float, shape: tuple[int, int] = (12, 16)) -> np.ndarray:
    return np.full(shape, depth, np.float32)


NOTHING = {
    "nothing moves": [flat(3.0)] * 10,
    "nothing returns": [flat(np.nan)] * 5,
    "one frame": [flat(3.0)],
    "one empty frame": [flat(np.nan)],
    "two frames": [flat(3.0), flat(3.1)],
    "one pixel": [flat(3.0 + 0.05 * t, (1, 1)) for t in range(10)],
    "one return": [np.where(np.arange(192).reshape(12, 16) == 40 + t, 3.0, np.nan) for t in range(10)],
    "one row": [flat(3.0 + 0.05 * t, (1, 20)) for t in range(10)],
    "all at once": [flat(3.0), flat(np.nan), flat(3.0), flat(np.nan), flat(5.0)],
}


@pytest.mark.parametrize("preset", ["default", "paper"])
@pytest.mark.parametrize("kind", NOTHING)
def test_where_there_is_nothing_to_find_nothing_is_found(kind: str, preset: str) -> None:
    recording = recording_of(NOTHING[kind])
    motions = solve(recording, preset_settings(preset))
    assert_well_formed(motions, recording)
    assert motions.motion_ids == []


def test_the_papers_preset_solves_a_small_world() -> None:
    """Eight trajectories in a segment are enough here, and all are clustered: the picture is small."""
    surfaces = [sphere(lambda t: (-0.8 + 0.05 * t, -0.3, 3.0), 0.4), plane(lambda _: 6.0)]
    recording = recorded(surfaces, frames=20, moving=[True, False])
    settings = preset_settings("paper", of_scene={"eps4": 8.0, "eps5": 2})
    motions = solve(recording, settings)
    assert_well_formed(motions, recording)
    assert len(motions.motion_ids) >= 1
    assert motions.making.settings["preset"] == "paper"
    assert all(object_of(recording, motions, motion)[1] > 0.9 for motion in motions.motion_ids)


@pytest.mark.parametrize("eps4", [0.0, 0.5])
def test_segments_of_any_size_may_be_kept(eps4: float) -> None:
    settings = replace_setting(eps4)
    surfaces = [sphere(lambda t: (-0.5 + 0.08 * t, 0.0, 3.0), 0.4), plane(lambda _: 6.0)]
    recording = recorded(surfaces, frames=10, moving=[True, False], camera=small_camera(40, 30))
    assert_well_formed(solve(recording, settings), recording)


def replace_setting(eps4: float) -> Settings:
    return Settings.model_validate(Settings().model_dump() | {"eps4": eps4})


def test_solving_leaves_the_recording_as_it_was() -> None:
    recording = recorded(
        [sphere(lambda t: (0.05 * t, 0, 3.0), 0.5), plane(lambda _: 5.0)], frames=6, moving=[True, False]
    )
    before = [frame.depth.copy() for frame in recording.frames]
    solve(recording)
    for mine, theirs in zip(before, recording.frames, strict=True):
        np.testing.assert_array_equal(mine, theirs.depth)
