"""Every choice of the solver as one frozen value, with its unit, its effect and the paper's symbol."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import Field

from recording.checks import Frozen, nearest_name, toml_document, validated
from recording.errors import InputError
from recording.markup import facts, folded, table

Positive = Annotated[float, Field(gt=0)]
Share = Annotated[float, Field(ge=0, le=1)]
Count = Annotated[int, Field(ge=1)]

Preset = Literal["default", "paper"]
PixelFlowName = Literal["classic_nl", "classic_nl_fast", "deepflow", "dis", "dis_refined", "farneback", "rlof", "tvl1"]
FlowName = Literal["range", PixelFlowName]
ImageName = Literal["grey", "nearness", "shading"]
ChainingName = Literal["pixels", "between_pixels"]
ClusteringName = Literal["common_fate", "spectral", "graph_merging"]
CompletingName = Literal["continuation", "bottom_up"]
AlignmentName = Literal["rigid", "translation"]


class Settings(Frozen):
    """The settings of `solve`. Lengths in point spacings refer to the recording's mean point spacing."""

    preset: Preset = "default"
    """The name of the set of values that these started from; it is chosen by `--preset`, not set."""

    remove_static: bool = True
    """Leave out what stands still before the flow; else only eps2 does."""
    static_tolerance_m: Positive = 0.03
    """Metres: a return this near to its pixel's usual depth stands still."""

    image: ImageName = "nearness"
    """What the flow sees: `grey` = depth as 8-bit grey (paper); `nearness` = what is near is bright, the farthest still
    stands out from emptiness; `shading` = the surface lit from the camera."""
    flow: FlowName = "range"
    """Optical flow between consecutive frames (paper: Classic+NL)."""
    similar_depth_m: Positive = 0.1
    """Metres: neighbours nearer than this in depth lie on the same surface (paper: epsilon of the kernel rho)."""
    fastest_m_per_s: Positive = 10.0
    """Metres a second: nothing comes nearer or goes away faster; a larger change of depth is another surface."""

    chaining: ChainingName = "between_pixels"
    """How matches become trajectories: from pixel to pixel (`pixels`, paper), or keeping the place between them."""
    jolt_m_per_s2: Positive = 100.0
    """Metres a second squared: a point whose motion changes more abruptly is lost (for `between_pixels`)."""
    eps1: Positive = 1.5
    """Point spacings: a match returns home within this distance (paper: epsilon 1)."""
    eps2: Annotated[float, Field(ge=0)] = 0.1
    """Metres: a trajectory of smaller extent is noise (paper: epsilon 2)."""
    shortest_frames: Count = 4
    """Frames: a shorter trajectory is noise."""
    points_apart_px: Count = 1
    """Pixels: the points that begin in every so many columns and rows are kept; 2 needs a quarter of the memory."""

    patch_radius_m: Positive = 0.25
    """Metres: a moving pixel belongs to the nearest followed point within this distance."""

    clustering: ClusteringName = "common_fate"
    """`common_fate` = united bottom up to the size of a body; `spectral` (paper); `graph_merging` of Felzenszwalb
    and Huttenlocher."""
    neighbours: Count = 12
    """Number of nearest trajectories in a frame that a trajectory is compared with."""
    neighbour_radius_m: Positive = 0.25
    """Metres: farther points are no neighbours."""
    loosest_m: Positive = 0.2
    """Metres: neighbours that keep together worse than this are not of one body (`grouping.separations`)."""
    widest_m: Positive = 1.25
    """Metres: no body is wider than this in any horizontal direction; an honest prior for people (paper: none)."""
    slimmest_m: Positive = 0.8
    """Metres: seen from some side every body is as slim as this; two people in step are not (paper: none)."""
    tallest_m: Positive = 2.2
    """Metres: no body is taller than this, with an umbrella up (paper: none)."""
    eps3: Positive = 10.0
    """traj_sim: pairs beyond it are ignored (paper: epsilon 3; not for `common_fate`)."""
    eps5: Count = 10
    """Every eps5-th trajectory is clustered, the others follow their nearest neighbour (paper: epsilon 5; not for
    `common_fate`)."""
    most_segments: Count = 60
    """Segments that the eigengap may find (for `spectral`)."""
    segment_count: Annotated[int, Field(ge=0)] = 0
    """Segments to find (for `spectral`), one a connected component at the least; 0 = the eigengap says how many."""
    merging_k: Positive = 10.0
    """traj_sim: the larger, the larger the segments (k of Felzenszwalb and Huttenlocher, for `graph_merging`)."""
    eps4: Annotated[float, Field(ge=0)] = 20.0
    """Trajectories: a smaller segment is noise, of those that are clustered (paper: epsilon 4); for `common_fate` a
    smaller motion is."""

    companion_gap_m: Positive = 0.4
    """Metres: segments farther apart than this are no parts of one body."""
    companion_stray_m: Positive = 0.65
    """Metres: a part's centre strays sideways at most this far from its mean place beside the other part."""
    companion_speed_m_per_s: Positive = 1.2
    """Metres a second: parts of one body move about one another slower than this on average; a thrown ball does not."""

    restlessness: Positive = 0.05
    """Square metres a second cubed: how much speed changes by itself; the less, the straighter paths are in holes."""

    completing: CompletingName = "continuation"
    """`continuation` = segments are linked over the whole recording first, then points are completed; `bottom_up` =
    in segments first, then across (paper)."""
    alignment: AlignmentName = "translation"
    """How the representative is laid on a trajectory: `rigid` (Horn, paper) or `translation`."""
    intra_gate: Positive = 8.0
    """Point spacings: a costlier pair of trajectories is not joined."""
    complete_unmatched: bool = True
    """Points last seen before a hole, or first seen after it, follow the representative through it, partner or not."""
    faint_below: Share = 0.5
    """A motion of which a smaller share of the usual number of points is seen counts as hidden for such points."""
    limb_swing: bool = True
    """Limbs swing on while they are hidden, as the visible part of the motion shows; else all goes rigidly along."""
    border_seconds: Positive = 0.2
    """Seconds before and after it is hidden in which such points were last or first seen."""

    eps6: Positive = 0.15
    """Metres: a polynomial with a larger error joins nothing (paper: epsilon 6, no value given)."""
    longest_overlap_seconds: Annotated[float, Field(ge=0)] = 2.0
    """Seconds that two segments of one body may be seen at the same time, on both sides of a trunk."""
    fastest_walk_m_per_s: Positive = 4.0
    """Metres a second: a hole that asks for more speed is not bridged."""
    restlessness_of_links: Positive = 0.3
    """Like `restlessness`, for the judgement of links, where a turn must be possible."""
    longest_hole_seconds: Positive = 3.0
    """Seconds: a longer hole is not bridged."""

    @property
    def fewest_trajectories(self) -> float:
        """Epsilon 4 among the trajectories that are kept (`points_apart_px`)."""
        return self.eps4 / self.points_apart_px**2

    def _repr_html_(self) -> str:
        """What differs from the preset, and all settings with their meaning, as a notebook shows them."""
        usual = preset_settings(self.preset)
        changed = [(name, value) for name, value in self if value != getattr(usual, name)]
        rows = [(name, value, Settings.model_fields[name].description) for name, value in self]
        differs = ", ".join(f"{name} = {value}" for name, value in changed) or "nothing"
        every = folded(f"All {len(rows)} settings", table(("setting", "value", "meaning"), rows))
        return str(facts([("preset", self.preset), ("changed", differs)]) + every)


_PAPER: dict[str, Any] = {
    "preset": "paper",
    "remove_static": False,
    "image": "grey",
    "flow": "classic_nl_fast",
    "similar_depth_m": 0.1,
    "fastest_m_per_s": 1000.0,
    "chaining": "pixels",
    "eps1": 0.5,
    "eps2": 0.1,
    "shortest_frames": 2,
    "eps3": 10.0,
    "eps4": 20,
    "eps5": 10,
    "neighbours": 12,
    "neighbour_radius_m": 0.25,
    "clustering": "spectral",
    "most_segments": 60,
    "segment_count": 0,
    "merging_k": 10.0,
    "completing": "bottom_up",
    "alignment": "rigid",
    "intra_gate": 8.0,
    "complete_unmatched": False,
    "limb_swing": False,
    "eps6": 0.15,
    "longest_hole_seconds": 1000.0,
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
