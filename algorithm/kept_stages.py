"""The results of the stages as files: Arrow tables, exact to the last bit."""

import json
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from jaxtyping import Bool, Int
from pyarrow import feather

from algorithm.completion import Completion
from algorithm.followed import Followed
from algorithm.moving_flows import MovingFlows
from algorithm.patches import Patches
from algorithm.representative import Curve
from algorithm.result import Motion
from algorithm.stages import Flowing, Grouped, Observed
from algorithm.trajectories import Trajectories
from recording.cache import Form
from recording.recording import Recording

_BELONGINGS = b"unocclude"


def _write_flowing(flowing: Flowing, path: Path) -> None:
    flows = flowing.flows
    column, row, depth = flows.flow.T
    known = {"shape": flows.shape, "begin": flows.begin.tolist(), "seconds": dict(flowing.seconds)}
    _write({"pixel": flows.pixel, "column": column, "row": row, "depth": depth}, known, path)


def _read_flowing(path: Path) -> Flowing:
    columns, known = _read(path)
    flows = MovingFlows(
        shape=tuple(known["shape"]),
        begin=np.array(known["begin"]),
        pixel=columns["pixel"],
        flow=np.stack([columns[name] for name in ("column", "row", "depth")], axis=1),
    )
    return Flowing(flows=flows, seconds=known["seconds"])


def _write_observed(observed: Observed, path: Path) -> None:
    followed = observed.followed
    x, y, z = followed.patches.centre.T
    patch = {"pixels": followed.patches.pixels, "patch_x": x, "patch_y": y, "patch_z": z}
    known = {"spacing_m": followed.spacing_m, "seconds": dict(observed.seconds)}
    _write(_columns(followed.trajectories) | patch, known, path)


def _read_observed(recording: Recording, path: Path) -> Observed:
    columns, known = _read(path)
    centre = np.stack([columns[name] for name in ("patch_x", "patch_y", "patch_z")], axis=1)
    followed = Followed(
        trajectories=_trajectories(columns),
        patches=Patches(pixels=columns["pixels"], centre=centre),
        spacing_m=known["spacing_m"],
        camera=recording.camera,
        fps=recording.fps,
        frames=len(recording.frames),
    )
    return Observed(followed=followed, seconds=known["seconds"])


def _write_grouped(grouped: Grouped, path: Path) -> None:
    _write({"segment": grouped.segments}, {"seconds": dict(grouped.seconds)}, path)


def _read_grouped(observed: Observed, path: Path) -> Grouped:
    columns, known = _read(path)
    return Grouped(followed=observed.followed, segments=columns["segment"], seconds=known["seconds"])


FLOWING = Form(read=_read_flowing, write=_write_flowing)


def observed_form(recording: Recording) -> Form[Observed]:
    """How the second stage's result is kept, without what its recording tells."""
    return Form(read=partial(_read_observed, recording), write=_write_observed)


def grouped_form(observed: Observed) -> Form[Grouped]:
    """How the third stage's result is kept, without that of the second."""
    return Form(read=partial(_read_grouped, observed), write=_write_grouped)


def motion_form(members: Bool[np.ndarray, "trajectory"], segments: Int[np.ndarray, "member"]) -> Form[Motion]:
    """How a motion of some members, whose segments are told, is kept: without these."""
    return Form(read=partial(_read_motion, members, segments), write=_write_motion)


def _write_motion(motion: Motion, path: Path) -> None:
    """A table of one row, whose entries are lists."""
    curve, completion = motion.curve, motion.completion
    columns = {f"curve_{axis}": curve.position[:, number] for number, axis in enumerate("xyz")}
    columns |= {axis: completion.position[:, number] for number, axis in enumerate("xyz")}
    columns |= {name: getattr(completion, name) for name in ("trajectory", "frame", "source", "confidence")}
    columns |= {"points": curve.points, "before": completion.joins[0], "after": completion.joins[1]}
    _write({name: [values] for name, values in columns.items()}, {"first": int(curve.first)}, path)


def _read_motion(members: Bool[np.ndarray, "trajectory"], segments: Int[np.ndarray, "member"], path: Path) -> Motion:
    lists, known = _read(path)
    columns = {name: np.array(values[0]) for name, values in lists.items()}
    curve = np.stack([columns[f"curve_{axis}"] for axis in "xyz"], axis=1)
    completion = Completion(
        position=np.stack([columns[axis] for axis in "xyz"], axis=1),
        joins=(columns["before"], columns["after"]),
        **{name: columns[name] for name in ("trajectory", "frame", "source", "confidence")},
    )
    return Motion(
        segments=tuple(np.unique(segments).tolist()),
        curve=Curve(first=known["first"], position=curve, points=columns["points"]),
        members=members,
        completion=completion,
    )


def _columns(trajectories: Trajectories) -> dict[str, np.ndarray]:
    x, y, z = trajectories.position.T
    column, row = trajectories.column_row.T
    own = {"trajectory": trajectories.trajectory, "frame": trajectories.frame}
    return {**own, "x": x, "y": y, "z": z, "column": column, "row": row}


def _trajectories(columns: dict[str, np.ndarray]) -> Trajectories:
    return Trajectories(
        trajectory=columns["trajectory"],
        frame=columns["frame"],
        position=np.stack([columns[name] for name in ("x", "y", "z")], axis=1),
        column_row=np.stack([columns[name] for name in ("column", "row")], axis=1),
    )


def _write(columns: dict[str, Any], known: dict[str, Any], path: Path) -> None:
    table = pa.table(columns).replace_schema_metadata({_BELONGINGS: json.dumps(known)})
    feather.write_feather(table, str(path), compression="zstd")


def _read(path: Path) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Columns that can be written to, as those of a result that was just made."""
    table = feather.read_table(str(path), memory_map=False)
    columns = {name: np.array(table.column(name).to_numpy()) for name in table.column_names}
    return columns, json.loads(table.schema.metadata[_BELONGINGS])
