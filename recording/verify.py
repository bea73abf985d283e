"""A simulated recording held against itself: depth, labels, meshes, X-rays, motion and feet must tell one story."""

from dataclasses import dataclass

from recording.agreement import AGREEMENTS
from recording.errors import InputError
from recording.feet import foot_sink_m, foot_slide_m
from recording.moment import Moment, moment_of
from recording.progress import tracked
from recording.recording import Recording
from recording.truth import Truth

FOOT_M = 0.02
"""How far a standing foot may slide, and how deep it may sink, metres."""


@dataclass(frozen=True, kw_only=True)
class Check:
    """The largest error of one kind in a whole recording."""

    name: str
    meaning: str
    """What was compared, in a few words."""
    largest: float
    """Infinite where one account says something and the other nothing."""
    bound: float
    """The largest error that passes."""
    unit: str

    @property
    def passes(self) -> bool:
        """Whether the error stays within its bound."""
        return self.largest <= self.bound


@dataclass(frozen=True, kw_only=True)
class Report:
    """What `verify` found."""

    checks: tuple[Check, ...]

    @property
    def passes(self) -> bool:
        """Whether every check passes."""
        return all(check.passes for check in self.checks)

    @property
    def text(self) -> str:
        """A line for each check: its largest error and its bound."""
        return "\n".join(
            f"{'ok  ' if check.passes else 'FAIL'} {check.name}: {check.largest:.3g} {check.unit}"
            f" (at most {check.bound:g}): {check.meaning}"
            for check in self.checks
        )


def verify(recording: Recording) -> Report:
    """The largest error of each kind, with its bound.

    Holds depth and camera against the labels' material points on the truth meshes (metres, and pixels in
    the picture), depth and X-ray twin against the meshes by a ray caster of its own, labels against depth and
    against the objects of `recording.json`, reasons against missing returns, flow against motion from each frame
    to the next, the X-ray twin against what is seen, and people's feet against the ground. Frames are read one
    by one. A recording without exact truth, as every real one, cannot be verified: an `InputError`.
    """
    truth = _checked_truth(recording)
    return Report(checks=(*_frame_checks(recording, truth), *_foot_checks(recording, truth)))


def _frame_checks(recording: Recording, truth: Truth) -> list[Check]:
    """What is compared in every frame."""
    agreements = [each for each in AGREEMENTS if recording.xray is not None or not each.of_xray]
    largest = {each.name: 0.0 for each in agreements}
    moment: Moment | None = None
    frames = tracked(recording.frames, "verifying", total=recording.metadata.frames)
    for number, frame in enumerate(frames):
        moment = moment_of(recording, truth, frame, number=number, before=moment)
        for each in agreements:
            largest[each.name] = max(largest[each.name], each.error(moment))
    return [
        Check(name=each.name, meaning=each.meaning, largest=largest[each.name], bound=each.bound, unit=each.unit)
        for each in agreements
    ]


def _foot_checks(recording: Recording, truth: Truth) -> list[Check]:
    """What is asked of people's meshes; nothing where there are none."""
    people = [truth[entry.id] for entry in recording.metadata.objects or () if entry.kind == "person"]
    if not people:
        return []
    slide, sink = max(map(foot_slide_m, people)), max(map(foot_sink_m, people))
    return [
        Check(name="feet slide", meaning="way of a foot while it stands", largest=slide, bound=FOOT_M, unit="m"),
        Check(name="feet sink", meaning="lowest point of a person below ground", largest=sink, bound=FOOT_M, unit="m"),
    ]


def _checked_truth(recording: Recording) -> Truth:
    """The meshes of a recording that has them, one for every object, as many frames as the recording."""
    if recording.truth is None or recording.metadata.objects is None:
        raise InputError("expected a recording with its truth, got one without: only simulated ones can be verified")
    for entry in recording.metadata.objects:
        mesh = recording.truth.get(entry.id)
        if mesh is None:
            raise InputError(f"object {entry.id} ({entry.name}) has no mesh in the truth: make the recording again")
        expected = recording.metadata.frames  # Of what stands, too: a juggler's arms move.
        if len(mesh.vertices) not in (expected, 1):
            came = f"got {len(mesh.vertices)}: make the recording again"
            raise InputError(f"object {entry.id} ({entry.name}): expected its mesh in {expected} frames, {came}")
    return recording.truth
