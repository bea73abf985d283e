"""Every choice of the solver as one frozen value, with its unit, its effect and the paper's symbol."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import Field

from recording.checks import Frozen, nearest_name, toml_document, validated
from recording.errors import InputError

Positive = Annotated[float, Field(gt=0)]
Share = Annotated[float, Field(ge=0, le=1)]
Count = Annotated[int, Field(ge=1)]

Preset = Literal["default", "paper"]
PixelFlowName = Literal["classic_nl", "classic_nl_fast", "deepflow", "dis", "dis_refined", "farneback", "rlof", "tvl1"]
FlowName = Literal["range", PixelFlowName]
ImageName = Literal["grey", "shading"]
ChainingName = Literal["pixels", "between_pixels"]
AffinityName = Literal["product", "spread"]
ClusteringName = Literal["eigengap", "normalised_cut"]
AlignmentName = Literal["rigid", "translation"]


class Settings(Frozen):
    """The settings of `solve`. Lengths in point spacings refer to the recording's mean point spacing."""

    preset: Preset = "default"
    """The name of the set of values that these started from; it is chosen by `--preset`, not set."""

    remove_static: bool = True
    """Leave out what stands still before the flow; else only eps2 does."""
    static_tolerance_m: Positive = 0.03
    """Metres: a return this near to its pixel's usual depth stands still."""

    image: ImageName = "shading"
    """What the flow sees: `grey` = depth as 8-bit grey (paper); `shading` = the surface lit from the camera."""
    flow: FlowName = "range"
    """Optical flow between consecutive frames (paper: Classic+NL)."""
    similar_depth_m: Positive = 0.1
    """Metres: neighbours nearer than this in depth lie on the same surface (paper: epsilon of the kernel rho)."""
    fastest_m_per_s: Positive = 10.0
    """Metres a second: nothing comes nearer or goes away faster; a larger change of depth is another surface."""

    chaining: ChainingName = "between_pixels"
    """How matches become trajectories: from pixel to pixel (`pixels`, paper), or keeping the place between them."""
    jolt_m_per_s2: Positive = 45.0
    """Metres a second squared: a point whose motion changes more abruptly is lost (for `between_pixels`)."""
    eps1: Positive = 1.5
    """Point spacings: a match returns home within this distance (paper: epsilon 1)."""
    eps2: Annotated[float, Field(ge=0)] = 0.1
    """Metres: a trajectory of smaller extent is noise (paper: epsilon 2)."""
    shortest_frames: Count = 4
    """Frames: a shorter trajectory is noise."""

    neighbours: Count = 12
    """Number of nearest trajectories in a frame that a trajectory is compared with."""
    neighbour_radius_m: Positive = 0.25
    """Metres: farther points are no neighbours."""
    affinity: AffinityName = "spread"
    """`product` = the paper's traj_sim; `spread` = how much the distance of two trajectories changes."""
    eps3: Positive = 3.0
    """Pairs beyond it are ignored: traj_sim for `product` (paper: epsilon 3), point spacings for `spread`."""
    eps5: Count = 6
    """Every eps5-th trajectory is clustered, the others follow their nearest neighbour (paper: epsilon 5)."""

    clustering: ClusteringName = "normalised_cut"
    """How the number of segments comes about: `eigengap`, or cuts while they are cheap (`normalised_cut`)."""
    cut_below: Share = 0.005
    """A segment is cut in two while the normalised cut costs less than this (for `normalised_cut`)."""
    most_segments: Count = 60
    """Segments that `eigengap` may find in one connected component."""
    eps4: Annotated[float, Field(ge=0)] = 20.0
    """Trajectories, of those that are clustered: a smaller segment is noise (paper: epsilon 4)."""

    fragment_share: Share = 0.35
    """A segment with at most this share of a near one's points is a limb of it; 0 = none is (paper)."""
    fragment_gap_m: Positive = 0.5
    """Metres: a segment farther from the other is no limb of it."""
    fragment_drift_m_per_s: Positive = 1.5
    """Metres a second: a segment that leaves the other faster is no limb of it."""

    drift_seconds: Annotated[float, Field(ge=0)] = 0.3
    """Seconds over which a representative is drawn to the centres of mass of well seen frames; 0 = never (paper)."""
    faint_share: Share = 0.6
    """A segment's ends with a smaller share of its points near the end do not count for linking; 0 = all count."""

    alignment: AlignmentName = "translation"
    """How the representative is laid on a trajectory: `rigid` (Horn, paper) or `translation`."""
    intra_gate: Positive = 8.0
    """Point spacings: a costlier pair of trajectories is not joined."""
    complete_unmatched: bool = True
    """Points last seen before a hole, or first seen after it, follow the representative through it, partner or not."""
    border_seconds: Positive = 0.4
    """Seconds before and after a hole in which such points were last or first seen."""

    eps6: Positive = 0.15
    """Metres: a polynomial with a larger error joins nothing (paper: epsilon 6, no value given)."""
    ends_seconds: Positive = 1.0
    """Seconds of both representatives, next to the hole, that the polynomial is fitted to."""
    longest_hole_seconds: Positive = 3.0
    """Seconds: a longer hole is not bridged."""
    spare_scraps: bool = True
    """Leaving a segment unlinked costs as much as it was seen, so that no body is left alone for a scrap."""


_PAPER: dict[str, Any] = {
    "preset": "paper",
    "remove_static": False,
    "image": "grey",
    "flow": "classic_nl_fast",
    "chaining": "pixels",
    "eps1": 0.5,
    "eps2": 0.1,
    "shortest_frames": 2,
    "affinity": "product",
    "eps3": 10.0,
    "eps4": 20,
    "eps5": 10,
    "clustering": "eigengap",
    "fragment_share": 0.0,
    "drift_seconds": 0.0,
    "faint_share": 0.0,
    "alignment": "rigid",
    "complete_unmatched": False,
    "ends_seconds": 1000.0,
    "longest_hole_seconds": 1000.0,
    "spare_scraps": False,
}
"""The paper's choices, with the epsilons that Table 1 gives for `wall`."""


def preset_settings(name: str, *, of_scene: Mapping[str, float] | None = None) -> Settings:
    """The settings of a preset; `paper` takes the epsilons that a scene states instead of wall's."""
    if name not in get_args(Preset):
        raise InputError(f"unknown preset {name!r}, {nearest_name(name, get_args(Preset))}")
    if name == "default":
        return Settings()
    return validated(Settings, _PAPER | dict(of_scene or {}), source="settings of the scene")


def changed_settings(settings: Settings, changes: Mapping[str, Any], *, source: str) -> Settings:
    """The settings with some of them replaced; `source` says in an error where the changes came from."""
    if changes.get("preset", settings.preset) != settings.preset:
        raise InputError(f"{source}: a preset is many settings, not one: choose it with --preset")
    return validated(Settings, settings.model_dump() | dict(changes), source=source)


def settings_from_file(settings: Settings, path: Path) -> Settings:
    """The settings with those that a TOML file names replaced."""
    return changed_settings(settings, toml_document(path), source=str(path))
