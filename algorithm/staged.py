"""Algorithm 1 in four stages, each made at most once where a cache keeps what it made."""

import hashlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Int

from algorithm.corrections import check_corrections
from algorithm.estimate import room_for
from algorithm.flow_parts import FlowParts, nobody
from algorithm.given import NOTHING_GIVEN, Given
from algorithm.kept_stages import grouped_form, motion_form, observed_form
from algorithm.pipeline import (
    completed_motions,
    footage_of,
    making_of,
    segmented,
    trajectories_along,
    with_patches,
)
from algorithm.result import Motion, motions_of
from algorithm.scene_flow import Footage, ThereAndBack, flows_between
from algorithm.settings import Settings
from algorithm.spacing import mean_point_spacing
from algorithm.stages import Flowing, Grouped, Observed, Stage, keys_of, readable
from algorithm.stopwatch import Stopwatch
from recording.cache import Cache, kept, key_of
from recording.corrections import Corrections
from recording.motions import Motions
from recording.progress import tracked
from recording.recording import Recording


def solve(
    recording: Recording,
    settings: Settings | None = None,
    given: Given = NOTHING_GIVEN,
    cache: Cache | None = None,
    corrections: Corrections | None = None,
    memory_bytes: int | None = None,
) -> Motions:
    """The motions in a recording, completed where they were hidden: those of `algorithm.pipeline.solve`, row for row.

    Of the recording nothing but depths, camera and frame rate is read. What is `given` takes a stage's place. A stage
    whose result the cache holds is not made again; seconds are those that its making took. `corrections` by hand, which
    must be of this recording, are respected from the links on. Where all depth images would take more than a quarter of
    `memory_bytes`, they are read again whenever they are needed; `estimated` says what the rest will take.
    """
    digest, settings = recording.digest(), settings or Settings()
    check_corrections(corrections, digest, settings, given)
    return Course(
        recording=recording,
        digest=digest,
        settings=settings,
        given=given,
        cache=cache,
        corrections=corrections,
        room=None if memory_bytes is None else room_for(recording.metadata, memory_bytes),
    ).motions()


@dataclass(frozen=True, kw_only=True, eq=False)
class Course:
    """A recording under some settings, from stage to stage; a stage takes the result of the one before, or makes it."""

    recording: Recording
    digest: str
    """The recording's."""
    settings: Settings
    given: Given = NOTHING_GIVEN
    cache: Cache | None = None
    corrections: Corrections | None = None
    room: int | None = None
    """Frames that stay in memory; all of them by default."""
    keys: dict[Stage, str] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "keys", keys_of(self.digest, self.settings))

    def flowing(self) -> tuple[Flowing, ...]:
        """How everything that moves moves from frame to frame (steps 0 to 2), in parts."""
        parts: list[Flowing] = []
        settings = readable(self.settings, "flow")
        for _ in self._pairs(self._footage(settings), settings, Stopwatch(), parts.append):
            pass
        return tuple(parts)

    def observed(self, flowing: Sequence[Flowing] = ()) -> Observed:
        """The points that move, followed for as long as they are seen (steps 3 and 4)."""
        key, form = self.keys["trajectories"], observed_form(self.recording)
        return kept(self._cache("trajectories"), key, lambda: self._made_observed(flowing), form)

    def grouped(self, observed: Observed | None = None) -> Grouped:
        """Which of them move together (steps 5 and 6)."""
        followed = observed or self.observed()
        key = self.keys["segments"]
        return kept(self._cache("segments"), key, lambda: self._made_grouped(followed), grouped_form(followed))

    def motions(self, grouped: Grouped | None = None) -> Motions:
        """What moves together, completed where it was hidden (steps 7 to 9)."""
        together, watch = grouped or self.grouped(), Stopwatch()
        watch.add(together.seconds)
        with watch.stage("completion"):
            solution = completed_motions(
                together.followed,
                together.segments,
                self.settings,
                self.given.links,
                self.corrections,
                self._kept_motion,
            )
        return motions_of(solution, making_of(self.digest, self.settings, watch.by_stage(), self.corrections))

    def _kept_motion(
        self, members: Bool[np.ndarray, "trajectory"], segments: Int[np.ndarray, "member"], make: Callable[[], Motion]
    ) -> Motion:
        """While somebody corrects by hand, motions are kept: a correction changes a few of many."""
        if self.corrections is None:
            return make()
        who = hashlib.sha256(np.flatnonzero(members).tobytes() + segments.tobytes()).hexdigest()
        key = key_of("motion", {"before": self.keys["motions"], "who": who})
        return kept(self._cache("motions"), key, make, motion_form(members, segments))

    def _made_observed(self, flowing: Sequence[Flowing]) -> Observed:
        watch, settings = Stopwatch(), readable(self.settings, "trajectories")
        footage = self._footage(settings)
        spacing_m = mean_point_spacing(footage.sensed, camera=footage.camera)
        pairs = _before(flowing, watch) if flowing else self._pairs(footage, settings, watch)
        trajectories = trajectories_along(pairs, footage, settings, spacing_m, watch)
        followed = with_patches(trajectories, footage, settings, spacing_m, watch)
        return Observed(followed=followed, seconds=watch.by_stage())

    def _made_grouped(self, observed: Observed) -> Grouped:
        watch, settings = Stopwatch(), readable(self.settings, "segments")
        watch.add(observed.seconds)
        given = self.given.segments
        segments = given(observed.followed.trajectories) if given else segmented(observed.followed, settings, watch)
        return Grouped(followed=observed.followed, segments=segments, seconds=watch.by_stage())

    def _footage(self, settings: Settings) -> Footage:
        return footage_of(self.recording, settings, self.room)

    def _pairs(
        self, footage: Footage, settings: Settings, watch: Stopwatch, told: Callable[[Flowing], None] = nobody
    ) -> Iterator[ThereAndBack]:
        """The flows of all pairs of frames, those that are not kept as they are made."""
        parts = FlowParts(
            flows=flows_between(footage, settings, self.given.flow),
            moving=footage.moving,
            key=self.keys["flow"],
            cache=self._cache("flow"),
            watch=watch,
            told=told,
        )
        return iter(tracked(parts.pairs(), "flow and matches", total=len(footage.moving) - 1))

    def _cache(self, stage: Stage) -> Cache | None:
        """The cache, unless something was given to the stage or to one before it: no key says what."""
        mended = self.given.flow is not None or (self.given.segments is not None and stage in ("segments", "motions"))
        return None if mended else self.cache


def _before(flowing: Sequence[Flowing], watch: Stopwatch) -> Iterator[ThereAndBack]:
    """The flows of all pairs of frames, made before."""
    for part in flowing:
        watch.add(part.seconds)
        yield from part.flows.pairs()
