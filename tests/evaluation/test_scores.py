"""All scores together: the contract's keys, the perfect result, the laws, bad input."""

import json
from dataclasses import replace

import numpy as np
import pytest
from known import (
    CAMERA,
    LEFT,
    RIGHT,
    all_noise,
    crossing,
    empty,
    leaves,
    masks_only,
    perfect,
    with_rows,
    without_rows,
)

from evaluation.scores import evaluate, scores
from recording.metadata import ObjectRecord
from recording.motions import Motions
from recording.parquet import load_motions, save_motions
from recording.recording import Recording, stripped
from recording.store import load_recording, save_recording

KEYS = {
    "": "scene frames objects points_per_frame holes longest_hole_frames coverage version preset",
    "trajectories": "count mean_frames purity",
    "segments": "count purity inverse_purity v_measure ari",
    "motions": "count found purity inverse_purity v_measure ari extracted over_segmented",
    "identity": "hota assa idf1 id_switches fragmentations",
    "completion": "hidden_object_frames recall median_m mean_m p95_m max_m within_1cm within_4cm within_16cm "
    "within_64cm centre_mean_m centre_max_m surface_coverage_10cm",
    "links": "precision recall",
    "events": "count true",
    "calibration": "right_links_above_90 "
    "links.0.begin links.0.end links.0.count links.0.holding links.0.share "
    "completed.0.begin completed.0.end completed.0.count completed.0.holding completed.0.share",
    "seconds": "flow match trajectories affinity clustering completion total",
}
SHARES = {
    *("coverage", "trajectories.purity", "identity.hota", "identity.assa", "identity.idf1"),
    *(
        f"{part}.{name}"
        for part in ("segments", "motions")
        for name in ("purity", "inverse_purity", "v_measure", "ari")
    ),
    *(f"completion.{name}" for name in ("recall", "surface_coverage_10cm", "within_1cm", "within_64cm")),
    *("links.precision", "links.recall"),
}
"""Those of which 1 is the best."""


@pytest.fixture(scope="module")
def recording() -> Recording:
    return crossing()


@pytest.fixture(scope="module")
def motions(recording: Recording) -> Motions:
    return perfect(recording)


def test_the_keys_are_the_contracts(recording: Recording, motions: Motions) -> None:
    expected = {f"{part}.{key}".lstrip(".") for part, keys in KEYS.items() for key in keys.split()}
    found = evaluate(recording, motions)
    assert set(leaves(found)) == expected
    assert list(found)[:8] == [*KEYS[""].split()[:7], "trajectories"]
    json.dumps(found, allow_nan=False)


def test_a_perfect_result_scores_perfectly(recording: Recording, motions: Motions) -> None:
    found = leaves(evaluate(recording, motions))
    assert {key: found[key] for key in SHARES} == dict.fromkeys(SHARES, 1.0)
    assert (found["objects"], found["motions.count"], found["motions.found"], found["motions.extracted"]) == (2,) * 4
    assert (found["holes"], found["longest_hole_frames"], found["segments.count"]) == (2, 11, 4)
    assert found["motions.over_segmented"] == found["identity.id_switches"] == 0
    assert found["completion.max_m"] < 1e-6
    assert found["completion.centre_max_m"] < 1e-6
    assert (found["preset"], found["seconds.flow"], found["seconds.match"]) == ("perfect", 1.0, None)


def test_on_a_recording_with_holes_only_times_can_be_unknown(recording: Recording, motions: Motions) -> None:
    unknown = {key for key, value in leaves(evaluate(recording, motions)).items() if value is None}
    assert all(key.startswith("seconds.") for key in unknown)


def test_representatives_are_not_needed(recording: Recording, motions: Motions) -> None:
    without = scores(recording, replace(motions, representatives=()))
    assert without["identity"] == scores(recording, motions)["identity"]


def test_lost_returns_cost_no_coverage() -> None:
    sparse = crossing(lost=0.3)
    assert evaluate(sparse, perfect(sparse))["coverage"] == 1


def test_names_and_order_do_not_matter(recording: Recording, motions: Motions) -> None:
    order = np.random.default_rng(1).permutation(len(motions))
    shuffled = motions.rows(order)
    renamed = replace(
        shuffled,
        motion=50 - shuffled.motion,
        segment=90 - shuffled.segment,
        trajectory=1000 - shuffled.trajectory,
        links=tuple(replace(link, before=90 - link.before, after=90 - link.after) for link in motions.links),
        representatives=tuple(replace(entry, motion=50 - entry.motion) for entry in motions.representatives),
    )
    assert leaves(scores(recording, renamed)) == pytest.approx(leaves(scores(recording, motions)), abs=1e-9)


def test_a_motion_that_breaks_at_the_hole_costs_identity_and_links(recording: Recording, motions: Motions) -> None:
    after = (motions.motion == LEFT) & (motions.frame > 18)
    found = leaves(scores(recording, with_rows(motions, motion=np.where(after, 5, motions.motion).astype(np.int32))))
    assert found["identity.id_switches"] == 1
    assert found["identity.hota"] < 0.9
    assert found["links.recall"] == 0.5
    assert found["motions.over_segmented"] == 1
    assert found["motions.purity"] == 1
    assert found["motions.inverse_purity"] < 0.8
    assert found["motions.found"] == 1


def test_swapped_motions_behind_the_wall_cost_purity_and_links(recording: Recording, motions: Motions) -> None:
    swapped = np.where(motions.frame > 18, LEFT + RIGHT - motions.motion, motions.motion).astype(np.int32)
    links = tuple(
        replace(link, after=other.after) for link, other in zip(motions.links, motions.links[::-1], strict=True)
    )
    found = leaves(scores(recording, replace(with_rows(motions, motion=swapped), links=links)))
    assert found["motions.purity"] < 0.8
    assert (found["links.precision"], found["links.recall"]) == (0, 0)
    assert found["identity.id_switches"] == 2
    assert found["motions.found"] == 0


def test_one_motion_of_everything_bridges_no_hole_but_that_of_its_main_object(
    recording: Recording, motions: Motions
) -> None:
    found = leaves(scores(recording, with_rows(motions, motion=np.full_like(motions.motion, 3))))
    assert found["links.recall"] == 0.5
    assert found["motions.inverse_purity"] == 1
    assert found["motions.extracted"] == 0


def test_links_that_are_not_listed_follow_from_the_motions(recording: Recording, motions: Motions) -> None:
    assert scores(recording, replace(motions, links=()))["links"] == {"precision": 1, "recall": 1}


@pytest.mark.parametrize("share", [0.2, 0.6, 0.95])
def test_leaving_points_out_never_helps(recording: Recording, motions: Motions, share: float) -> None:
    left_out = np.random.default_rng(2).random(len(motions)) < share
    found, best = (leaves(scores(recording, rows)) for rows in (without_rows(motions, left_out), motions))
    assert all(found[key] <= best[key] for key in SHARES)
    assert found["coverage"] == pytest.approx(1 - share, abs=0.05)


@pytest.mark.parametrize("seed", range(4))
def test_of_a_bad_result_too_coverage_and_recall_fall_with_the_points(
    recording: Recording, motions: Motions, seed: int
) -> None:
    """Who leaves out what is wrong may gain purity or a smaller error, and pays for it here."""
    generator = np.random.default_rng(seed)
    wrong = generator.random(len(motions)) < 0.3
    position = (
        motions.position + generator.normal(0, 0.1, (len(motions), 1)).astype(np.float32) * ~motions.observed[:, None]
    )
    bad = with_rows(
        motions,
        motion=np.where(wrong, LEFT + RIGHT - motions.motion, motions.motion).astype(np.int32),
        position=position,
    )
    cleaned = without_rows(bad, wrong | (np.abs(position - motions.position) > 0.1).any(axis=1))
    found, best = leaves(scores(recording, bad)), leaves(scores(recording, cleaned))
    assert best["motions.purity"] > found["motions.purity"]
    assert best["completion.mean_m"] < found["completion.mean_m"]
    for name in ("coverage", "completion.recall", "completion.surface_coverage_10cm"):
        assert best[name] <= found[name]
    assert best["coverage"] < found["coverage"]


def test_noise_is_lost_to_coverage(recording: Recording, motions: Motions) -> None:
    noise = motions.observed & (motions.motion == RIGHT)
    found = leaves(scores(recording, with_rows(motions, motion=np.where(noise, -1, motions.motion).astype(np.int32))))
    assert 0.5 < found["coverage"] < 0.7
    assert found["motions.found"] == 1


def test_points_on_the_wall_cost_purity(recording: Recording, motions: Motions) -> None:
    """Rows put on the wall in the picture carry the background's label, whatever motion claims them."""
    column_row = motions.column_row.copy()
    wrong = np.flatnonzero(motions.observed & (motions.motion == LEFT))[::4]
    column_row[wrong] = [CAMERA.cx, CAMERA.cy]
    found = leaves(scores(recording, with_rows(motions, column_row=column_row)))
    assert found["motions.purity"] < 0.9
    assert found["trajectories.purity"] < 0.95


def test_motions_of_nothing_have_no_scores_but_those_of_what_is_missing(recording: Recording) -> None:
    for nothing in (empty(), all_noise(perfect(recording))):
        found = leaves(scores(recording, nothing))
        missed = ("coverage", "motions.found", "identity.hota", "completion.recall", "links.recall")
        assert {key: found[key] for key in missed} == dict.fromkeys(missed, 0)
        unknown = ("motions.purity", "motions.ari", "segments.purity", "completion.median_m", "links.precision")
        assert {key: found[key] for key in unknown} == dict.fromkeys(unknown)
        json.dumps(found, allow_nan=False)


def test_where_nothing_is_hidden_there_is_no_completion() -> None:
    recording = crossing(wall=False)
    alone = Recording(
        metadata=recording.metadata.model_copy(
            update={"objects": (ObjectRecord(id=LEFT, name="one", kind="box", moving=True),)}
        ),
        frames=recording.frames,
        truth=recording.truth,
        xray=recording.xray,
    )
    whole = perfect(recording)
    found = scores(alone, replace(without_rows(whole, whole.motion == RIGHT), links=()))
    assert found["objects"] == 1
    assert (found["holes"], found["longest_hole_frames"]) == (0, None)
    assert set(found["completion"].values()) == {None}
    assert found["links"] == {"precision": 1, "recall": None}
    assert found["identity"]["hota"] == 1


def test_where_nothing_moves_nothing_can_be_found(recording: Recording, motions: Motions) -> None:
    standing = tuple(entry.model_copy(update={"moving": False}) for entry in recording.metadata.objects)
    still = Recording(
        metadata=recording.metadata.model_copy(update={"objects": standing}),
        frames=recording.frames,
        truth=recording.truth,
        xray=[{} for _ in recording.xray],
    )
    found = leaves(scores(still, motions))
    assert found["objects"] == 0
    for key in ("coverage", "motions.found", "identity.hota", "completion.recall", "links.recall"):
        assert found[key] is None


def test_masks_give_segmentation_and_nothing_that_needs_the_hidden(recording: Recording, motions: Motions) -> None:
    found = evaluate(masks_only(recording), motions)
    assert found["coverage"] == found["motions"]["purity"] == found["motions"]["ari"] == 1
    assert (found["objects"], found["motions"]["found"]) == (2, 2)
    assert set(found["identity"].values()) == set(found["completion"].values()) == {None}
    assert found["segments"]["inverse_purity"] is None
    assert found["links"] == {"precision": 1, "recall": None}


def test_a_bare_recording_has_counts_alone(recording: Recording, motions: Motions) -> None:
    found = leaves(evaluate(stripped(recording), motions))
    known = {key for key, value in found.items() if value is not None}
    assert known == {
        *("frames", "points_per_frame", "trajectories.count", "trajectories.mean_frames", "segments.count"),
        *("motions.count", "version", "preset", "seconds.flow", "seconds.total"),
    }


def test_files_score_as_values_do(recording: Recording, motions: Motions, tmp_path) -> None:
    save_recording(recording, tmp_path / "crossing")
    save_motions(motions, tmp_path / "motions.parquet")
    stored = evaluate(load_recording(tmp_path / "crossing"), load_motions(tmp_path / "motions.parquet"))
    assert leaves(stored) == pytest.approx(leaves(evaluate(recording, motions)))
