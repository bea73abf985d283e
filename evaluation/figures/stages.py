"""What the solver had in its hands on the way, made again from the motions that it wrote.

Followed trajectories, the curve of each segment, and the polynomials that could have joined two of them.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import get_args

import numpy as np
from jaxtyping import Float, Int

from algorithm.inter import HIGHEST_DEGREE, LOWEST_DEGREE, Polynomial, fitted_polynomial
from algorithm.representative import Curve, representative
from algorithm.settings import Preset, Settings
from algorithm.static import Background, background
from algorithm.trajectories import Trajectories
from evaluation.figures.panels import ELEVATION, Plane, in_camera, moments_of, plane_of
from evaluation.figures.views import View, front_view, raised_view
from recording.checks import validated
from recording.motions import Motions, Representative, mean_places
from recording.recording import Recording
from recording.visibility import surface_points, visibility_of

_ENDS_SECONDS = 1.0
"""Of both representatives, next to a hole, that a candidate is fitted to."""
_MOMENTS, _MOMENTS_RAISED = 6, 4
_FRAMES_SHOWN = 24
"""Frames that must fit into a view."""
_DEEP = 0.4
"""Share of its width from which on the depth of a scene is worth looking at from above."""
Pair = tuple[int, int]
"""A segment that ends and one that begins."""


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """A polynomial that could join two segments."""

    pair: Pair
    polynomial: Polynomial
    """Of the lowest degree that fits; of the least error where none does."""
    fits: bool
    """Whether its error is below epsilon 6."""

    @property
    def name(self) -> str:
        """Its degree and its error, for a legend."""
        return f"degree {self.polynomial.degree}, error {100 * self.polynomial.error_m:.1f} cm"


@dataclass(frozen=True, kw_only=True, eq=False)
class Solved:
    """A recording, the motions found in it, and what lies between."""

    recording: Recording
    motions: Motions

    @cached_property
    def settings(self) -> Settings:
        """What it was solved with; the default ones where something else solved it."""
        known = self.motions.making.settings
        ours = known.get("preset") in get_args(Preset)
        return validated(Settings, known, source="settings of the motions") if ours else Settings()

    @property
    def representatives(self) -> tuple[Representative, ...]:
        """The curve of every motion."""
        return self.motions.representatives or mean_places(self.motions)

    @cached_property
    def trajectories(self) -> Trajectories:
        """The trajectories as they were before completion joined them; two that it joined without a gap stay one."""
        seen = self.motions.rows(self.motions.observed)
        begins = np.ones(len(seen), bool)
        same = (np.diff(seen.trajectory) == 0) & (np.diff(seen.segment) == 0)
        begins[1:] = ~(same & (np.diff(seen.frame) == 1))
        return Trajectories(
            trajectory=np.cumsum(begins) - 1,
            frame=seen.frame.astype(int),
            position=seen.position.astype(np.float64),
            column_row=seen.column_row.astype(np.float64),
        )

    @cached_property
    def segment(self) -> Int[np.ndarray, "trajectory"]:
        """The segment of each of them, -1 for noise."""
        return self.motions.segment[self.motions.observed][self.trajectories.first_row].astype(int)

    @cached_property
    def curves(self) -> Mapping[int, Curve]:
        """The representative of each segment (step 7 of the paper)."""
        numbers = np.unique(self.segment[self.segment >= 0])
        chosen = {int(number): self.trajectories.chosen(self.segment == number) for number in numbers}
        return {number: representative(part) for number, part in chosen.items()}

    @cached_property
    def ground(self) -> Background:
        """What stands still."""
        depths = [frame.depth for frame in self.recording.frames]
        return background(depths, tolerance_m=self.settings.static_tolerance_m)

    @cached_property
    def still(self) -> Float[np.ndarray, "place 3"]:
        """The places of what stands still, world axes, metres."""
        return surface_points(self.recording.camera, self.ground.depth)

    def returns(self, frame: int) -> Float[np.ndarray, "place 3"]:
        """The places of all returns of a frame, world axes, metres."""
        return surface_points(self.recording.camera, self.recording.frames[frame].depth)

    def moving_returns(self, frame: int) -> Float[np.ndarray, "place 3"]:
        """The places of the returns of a frame that do not stand still, world axes, metres."""
        depth = self.recording.frames[frame].depth
        return surface_points(self.recording.camera, np.where(self.ground.moving(depth), depth, np.nan))

    @cached_property
    def centres(self) -> list[Float[np.ndarray, "moment 3"]]:
        """The true places of the moving objects while they are in view; none where they are not known."""
        centres = visibility_of(self.recording).centre if self.recording.xray is not None else None
        known = [] if centres is None else [centre[np.isfinite(centre[:, 0])] for centre in centres]
        return [centre for centre in known if len(centre)]

    @cached_property
    def plane(self) -> Plane:
        """The plane on which the motions are told apart best."""
        return plane_of(self.recording, self.centres or [curve.position for curve in self.representatives])

    @cached_property
    def moments(self) -> list[int]:
        """Frames that stand for the recording: more where they do not lie upon one another."""
        return moments_of(self.recording.metadata.frames, _MOMENTS_RAISED if self._raised else _MOMENTS)

    @cached_property
    def view(self) -> View:
        """From the sensor's place; from above it where people stand in line."""
        return self.above if self._raised else front_view(self.recording, self.shown)

    @cached_property
    def above(self) -> View:
        """From above the sensor's place, which parts walkers; balls are looked at from the front."""
        return (front_view if self.plane == ELEVATION else raised_view)(self.recording, self.shown)

    @cached_property
    def shown(self) -> Float[np.ndarray, "place 3"]:
        """The places that a view has to show: all returns, or of a juggler's scene those that move."""
        of_frame = self.moving_returns if self.plane == ELEVATION else self.returns
        places = [of_frame(frame) for frame in moments_of(self.recording.metadata.frames, _FRAMES_SHOWN, margin=0.0)]
        ahead = self.recording.camera.world_from_camera @ (0.0, 0.0, 1.0, 1.0)  # There is something to look at always.
        return np.concatenate([*places, *([] if any(map(len, places)) else [ahead[None, :3]])])

    @cached_property
    def _raised(self) -> bool:
        places = self.centres or [curve.position for curve in self.representatives]
        if not places or self.plane == ELEVATION:
            return False
        right, _, forward = np.ptp(in_camera(self.recording, np.concatenate(places)), axis=0)
        return bool(forward > _DEEP * right)

    @property
    def links(self) -> list[Pair]:
        """The segments that were joined, in the order of their first segments."""
        return sorted((link.before, link.after) for link in self.motions.links)

    def motion_of(self, segment: int) -> int:
        """The motion that a segment belongs to."""
        return int(self.motions.motion[np.flatnonzero(self.motions.segment == segment)[0]])

    @cached_property
    def candidates(self) -> Mapping[Pair, Candidate]:
        """For each pair of segments of which one may follow the other the polynomial between them."""
        longest = self.settings.longest_hole_seconds * self.recording.fps
        pairs = [(i, j) for i in self.curves for j in self.curves]
        near = [(i, j) for i, j in pairs if 0 < self.curves[j].first - self.curves[i].last <= longest]
        return {pair: found for pair in near if (found := self._candidate(pair)) is not None}

    def _candidate(self, pair: Pair) -> Candidate | None:
        before, after = self._ends(pair)
        highest = min(HIGHEST_DEGREE, len(before.position) + len(after.position) - 2)
        fits = [fitted_polynomial(before, after, degree=degree) for degree in range(LOWEST_DEGREE, highest + 1)]
        good = next((fit for fit in fits if fit.error_m < self.settings.eps6), None)
        best = good or min(fits, key=lambda fit: fit.error_m, default=None)
        return Candidate(pair=pair, polynomial=best, fits=good is not None) if best is not None else None

    def _ends(self, pair: Pair) -> tuple[Curve, Curve]:
        """The stretches next to the hole that a polynomial is fitted to."""
        before, after = (self.curves[number] for number in pair)
        length = max(1, round(_ENDS_SECONDS * self.recording.fps))
        return (
            before.between(max(before.first, before.last - length + 1), before.last),
            after.between(after.first, min(after.last, after.first + length - 1)),
        )

    def path(self, candidate: Candidate, *, hole: bool = False) -> Float[np.ndarray, "moment 3"]:
        """The places of a candidate, four a frame, metres: all that it was fitted to, or the hole alone."""
        found = candidate.polynomial
        before, after = (self.curves[number] for number in candidate.pair)
        begin, end = (before.last, after.first) if hole else (found.begin, found.end)
        return found.at(np.linspace(begin, end, round(4 * (end - begin)) + 1))

    @cached_property
    def names(self) -> Mapping[int, str]:
        """A name for each segment's representative, r1, r2 and so on in the order of their beginnings."""
        order = sorted(self.curves, key=lambda number: (self.curves[number].first, number))
        return {number: f"r{place}" for place, number in enumerate(order, start=1)}
