"""Algorithm 1 of the paper: from a recording to motions."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Float32

from algorithm import clustering
from algorithm.at_hand import AtHand
from algorithm.bottom_up import Reach, completed_bottom_up
from algorithm.chaining import chained
from algorithm.continued import common_fates, continued
from algorithm.corrections import check_corrections, corrected
from algorithm.followed import Followed
from algorithm.following import Tolerances, followed
from algorithm.given import NOTHING_GIVEN, Given, Linker, Segments
from algorithm.matching import Pairs, matched_pixels
from algorithm.observations import Observations, sorted_trajectories
from algorithm.patches import patches
from algorithm.result import Keep, Solution, made_now, motions_of
from algorithm.scene_flow import FlowsBetween, Footage, ThereAndBack, flows_between
from algorithm.settings import Settings
from algorithm.spacing import mean_point_spacing
from algorithm.static import background
from algorithm.stopwatch import Stopwatch
from algorithm.trajectories import Trajectories, lasting, thinned
from recording.corrections import Corrections
from recording.motions import Making, Motions
from recording.progress import tracked
from recording.recording import Recording
from recording.version import VERSION

Depths = Sequence[Float32[np.ndarray, "row column"]]


def solve(
    recording: Recording,
    settings: Settings | None = None,
    given: Given = NOTHING_GIVEN,
    corrections: Corrections | None = None,
) -> Motions:
    """The motions in a recording, completed where they were hidden.

    Of the recording nothing but depths, camera and frame rate is read. What is `given` takes a stage's place;
    `corrections` by hand, which must be of this recording, are respected from the links on.
    """
    settings = settings or Settings()
    digest = recording.digest()
    check_corrections(corrections, digest, settings, given)
    watch = Stopwatch()
    followed = followed_points(recording, settings, watch, given)
    segments = given.segments(followed.trajectories) if given.segments else segmented(followed, settings, watch)
    with watch.stage("completion"):
        solution = completed_motions(followed, segments, settings, given.links, corrections)
    return motions_of(solution, making_of(digest, settings, watch.by_stage(), corrections))


def making_of(
    recording_digest: str, settings: Settings, seconds: Mapping[str, float], corrections: Corrections | None
) -> Making:
    """How motions were made."""
    return Making(
        settings=settings.model_dump(),
        recording_digest=recording_digest,
        version=VERSION,
        seconds=dict(seconds),
        corrections=corrections,
    )


def followed_points(
    recording: Recording, settings: Settings, watch: Stopwatch, given: Given = NOTHING_GIVEN
) -> Followed:
    """The points of the recording that move, followed for as long as they are seen (steps 0 to 4)."""
    footage = footage_of(recording, settings)
    spacing_m = mean_point_spacing(footage.sensed, camera=footage.camera)
    flows = timed_flows(flows_between(footage, settings, given.flow), len(footage.moving), watch)
    trajectories = trajectories_along(flows, footage, settings, spacing_m, watch)
    return with_patches(trajectories, footage, settings, spacing_m, watch)


def footage_of(recording: Recording, settings: Settings, room: int | None = None) -> Footage:
    """The frames as the solver sees them; with `room`, so many stay in memory, and others are read when needed."""
    frames = recording.frames
    at_hand = len(frames) if room is None else room
    sensed = AtHand(lambda number: frames[number].depth, len(frames), room=at_hand)
    moving = moving_depths(sensed, settings, at_hand) if settings.remove_static else sensed
    return Footage(moving=moving, sensed=sensed, camera=recording.camera, fps=recording.fps)


def with_patches(
    trajectories: Trajectories, footage: Footage, settings: Settings, spacing_m: float, watch: Stopwatch
) -> Followed:
    """The trajectories with the part of the picture that each of their points stands for."""
    with watch.stage("trajectories"):
        around = patches(trajectories, footage.moving, camera=footage.camera, reach_m=settings.patch_radius_m)
    return Followed(
        trajectories=trajectories,
        patches=around,
        spacing_m=spacing_m,
        camera=footage.camera,
        fps=footage.fps,
        frames=len(footage.moving),
    )


def moving_depths(depths: Depths, settings: Settings, room: int | None = None) -> AtHand:
    """The depths without what stands still, each made when it is asked for; all of them, or `room`, stay in memory."""
    still = background(depths, tolerance_m=settings.static_tolerance_m)

    def moving(number: int) -> Float32[np.ndarray, "row column"]:
        return np.where(still.moving(depths[number]), depths[number], np.float32(np.nan))

    return AtHand(moving, len(depths), room=len(depths) if room is None else room)


def timed_flows(flows: FlowsBetween, frames: int, watch: Stopwatch) -> Iterator[ThereAndBack]:
    """The flows between consecutive frames, there and back, each made when it is asked for (steps 1 and 2)."""
    for a in tracked(range(frames - 1), "flow and matches", total=frames - 1):
        with watch.stage("flow"):
            both = flows(a, a + 1)
        yield both


def trajectories_along(
    flows: Iterable[ThereAndBack], footage: Footage, settings: Settings, spacing_m: float, watch: Stopwatch
) -> Trajectories:
    """The trajectories that are no noise (steps 3 and 4)."""
    history = observed_points(flows, footage, settings, spacing_m, watch)

    def keep(some: Trajectories) -> Trajectories:
        fewer = thinned(some, apart_px=settings.points_apart_px)
        return lasting(fewer, extent_m=settings.eps2, frames=settings.shortest_frames)

    with watch.stage("trajectories"):
        return sorted_trajectories(history, camera=footage.camera, keep=keep)


def observed_points(
    flows: Iterable[ThereAndBack], footage: Footage, settings: Settings, spacing_m: float, watch: Stopwatch
) -> list[Observations]:
    """The points that are followed in every frame."""
    if settings.chaining == "pixels":
        return chained(footage.moving, matched_frames(flows, footage, settings, spacing_m, watch))
    tolerances = Tolerances(
        surface_m=settings.similar_depth_m,
        home_m=settings.eps1 * spacing_m,
        jolt_m=settings.jolt_m_per_s2 / footage.fps**2,
    )
    return followed(footage.moving, flows, camera=footage.camera, tolerances=tolerances, watch=watch)


def matched_frames(
    flows: Iterable[ThereAndBack], footage: Footage, settings: Settings, spacing_m: float, watch: Stopwatch
) -> Iterator[Pairs]:
    """The matches of every pair of consecutive frames (step 3)."""
    for pair, both in zip(pairwise(footage.moving), flows, strict=True):
        with watch.stage("match"):
            pairs = matched_pixels(
                both,
                pair,
                camera=footage.camera,
                tolerance_m=settings.eps1 * spacing_m,
                similar_depth_m=settings.similar_depth_m,
            )
        yield pairs


def segmented(followed: Followed, settings: Settings, watch: Stopwatch) -> Segments:
    """The segment of every trajectory, -1 for noise (steps 5 and 6)."""
    if settings.clustering != "common_fate":
        return clustering.clustered(followed.trajectories, settings, followed.spacing_m, watch)
    with watch.stage("clustering"):
        return common_fates(followed, settings)


def completed_motions(
    followed: Followed,
    segments: Segments,
    settings: Settings,
    linker: Linker | None = None,
    corrections: Corrections | None = None,
    keep: Keep = made_now,
) -> Solution:
    """Segments joined into motions, and every point's places while it was hidden (steps 7 to 9)."""
    if corrections is not None:
        mended = corrected(followed, segments, settings, corrections)
        return continued(followed, mended.segments, settings, linker, mended.guidance, keep)
    if settings.completing == "continuation":
        return continued(followed, segments, settings, linker)
    reach = Reach(
        gate_m=settings.intra_gate * followed.spacing_m,
        longest_frames=settings.longest_hole_seconds * followed.fps,
    )
    return completed_bottom_up(followed.trajectories, segments, settings, reach, linker)
