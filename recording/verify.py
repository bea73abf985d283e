"""A simulated recording held against itself: depth, labels, meshes, X-rays, motion and people must tell one story."""

from dataclasses import dataclass
from itertools import product

from recording.agreement import AGREEMENTS
from recording.crowd import centre_track, deepest_inside_m, outline_distance_m, smallest_gap_m
from recording.errors import InputError
from recording.feet import foot_sink_m, foot_slide_m
from recording.moment import Moment, moment_of
from recording.progress import tracked
from recording.recording import Recording
from recording.truth import MeshSequence, Truth

FOOT_M = 0.02
"""How far a standing foot may slide, and how deep it may sink, metres."""
CENTRE_M = 0.05
"""How far the centre that is found by a mesh may lie from the one that the scene means, metres."""
INSIDE_M = 0.0
"""How deep people may get into obstacles, metres."""
_PEOPLE = ("person", "juggler")
_OBSTACLES = ("box", "cylinder", "cone")


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

    @property
    def sentence(self) -> str:
        """The error and its bound."""
        return f"{self.largest:.3g} {self.unit} (at most {self.bound:g})"

    @property
    def text(self) -> str:
        """One line: whether it passes, its error, its bound, its meaning."""
        return f"{'ok  ' if self.passes else 'FAIL'} {self.name}: {self.sentence}: {self.meaning}"


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
        return "\n".join(check.text for check in self.checks)


def verify(recording: Recording) -> Report:
    """The largest error of each kind, with its bound.

    Holds depth and camera against the labels' material points on the truth meshes (metres, and pixels in
    the picture), depth and X-ray twin against the meshes by a ray caster of its own, labels against depth and
    against the objects of `recording.json`, reasons against missing returns, flow against motion from each frame
    to the next, the X-ray twin against what is seen, people's feet against the ground, and people against one
    another and obstacles. Frames are read one by one. A recording without exact truth, as every real one, cannot
    be verified: an `InputError`.
    """
    truth = _checked_truth(recording)
    people = [*_foot_checks(recording, truth), *_crowd_checks(recording, truth)]
    return Report(checks=(*_frame_checks(recording, truth), *people))


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


def _crowd_checks(recording: Recording, truth: Truth) -> list[Check]:
    """What is asked of people among each other and among obstacles; nothing in a stress test."""
    scene = recording.metadata.scene or {}
    people, obstacles = (_of_kinds(recording, truth, kinds) for kinds in (_PEOPLE, _OBSTACLES))
    if scene.get("stress_test"):
        return []
    centres, asked, checks = [centre_track(mesh) for mesh in people], scene.get("vary", {}), []
    if len(people) > 1 and "clearance_m" in asked:
        short = asked["clearance_m"] - smallest_gap_m(centres)
        checks.append(_shortfall("people apart", "between two people", short, 2 * CENTRE_M))
    if people and obstacles and "obstacle_clearance_m" in asked:
        short = asked["obstacle_clearance_m"] - min(outline_distance_m(*pair) for pair in product(obstacles, centres))
        checks.append(_shortfall("clear of obstacles", "to obstacles", short, CENTRE_M))
    if people and obstacles:
        inside, meaning = (
            max(deepest_inside_m(*pair) for pair in product(obstacles, people)),
            "depth of people in obstacles",
        )
        checks.append(Check(name="inside obstacles", meaning=meaning, largest=inside, bound=INSIDE_M, unit="m"))
    return checks


def _shortfall(name: str, where: str, short_m: float, bound: float) -> Check:
    meaning = f"what people's centres lack of the distance that the scene asks {where}"
    return Check(name=name, meaning=meaning, largest=max(0.0, short_m), bound=bound, unit="m")


def _of_kinds(recording: Recording, truth: Truth, kinds: tuple[str, ...]) -> list[MeshSequence]:
    return [truth[entry.id] for entry in recording.metadata.objects or () if entry.kind in kinds]


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
