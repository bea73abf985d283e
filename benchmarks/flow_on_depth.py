"""End-point errors of flows on simulated depth; `flow.py` prints them where no Middlebury folder is named."""

import time
from collections.abc import Sequence
from itertools import product
from typing import get_args

import numpy as np

import unocclude
from algorithm.pipeline import moving_depths
from algorithm.scene_flow import Footage, flows_between
from algorithm.settings import FlowName, Settings, changed_settings
from benchmarks.tables import Row, mean_row
from evaluation.flow_errors import FlowErrors, flow_errors
from recording.errors import InputError
from recording.recording import Recording

BASELINE = "deepflow:grey"
"""What the default is held against."""
PAIRS = 8
"""Pairs of consecutive frames a recording, spread evenly."""
_PARTS = {"head": (0.87, 1.01), "trunk": (0.5, 0.87), "thighs": (0.28, 0.5), "calves, feet": (-0.01, 0.28)}
"""By the share of the body's height."""


def depth_rows(
    scenes: Sequence[str], seeds: Sequence[int], sensors: Sequence[str], flows: Sequence[str], *, size: str
) -> list[Row]:
    """A row a scene, sensor and flow, the mean over the seeds; a flow is `NAME` or `NAME:IMAGE`, as in the settings."""
    rows = []
    for scene, sensor in product(scenes, sensors):
        measured: dict[str, list[Row]] = {flow: [] for flow in flows}
        for seed in seeds:
            recording = unocclude.simulate(scene, seed=seed, size=size, sensor=sensor)
            for flow in flows:
                measured[flow].append(_row(recording, _settings(flow)))
        rows += [{"scene": scene, "sensor": sensor, "flow": flow} | mean_row(each) for flow, each in measured.items()]
    return _with_ratios(rows)


def _settings(flow: str) -> Settings:
    name, _, image = flow.partition(":")
    if name not in get_args(FlowName):
        raise InputError(f"--flows: unknown flow {name!r}: expected one of {', '.join(get_args(FlowName))}")
    return changed_settings(Settings(), {"flow": name} | ({"image": image} if image else {}), source="--flows")


def _row(recording: Recording, settings: Settings) -> Row:
    """The errors over pairs of frames in both directions, and the time of a pair."""
    sensed = [frame.depth for frame in recording.frames]
    moving = moving_depths(sensed, settings)
    flows = flows_between(Footage(moving=moving, sensed=sensed, camera=recording.camera, fps=recording.fps), settings)
    flows(0, 1)  # Compiled now, not on the clock.
    found, seconds = [], 0.0
    chosen = np.unique(np.linspace(0.1, 0.9, PAIRS) * (len(moving) - 2)).astype(int).tolist()
    for a in chosen:
        begun = time.perf_counter()
        forward, backward = flows(a, a + 1)
        seconds += time.perf_counter() - begun
        found += [flow_errors(recording, forward, a, a + 1), flow_errors(recording, backward, a + 1, a)]
    return _summary(found) | {"ms a pair": 1000 * seconds / len(chosen)}


def _summary(errors: Sequence[FlowErrors]) -> Row:
    pixels, metres, height, edge = (
        np.concatenate([getattr(one, name) for one in errors])
        for name in ("pixels", "metres", "height_share", "edge_px")
    )
    parts = {part: (height >= low) & (height < high) for part, (low, high) in _PARTS.items()}
    places = parts | {"edge < 3 px": edge < 3, "inside": edge >= 3}
    return {"px": float(pixels.mean()), "median px": float(np.median(pixels)), "cm": 100 * float(metres.mean())} | {
        name: float(pixels[where].mean()) if where.any() else None for name, where in places.items()
    }


def _with_ratios(rows: list[Row]) -> list[Row]:
    """Each row with its errors as a share of the baseline's in the same scene under the same sensor."""
    base = {(row["scene"], row["sensor"]): row for row in rows if row["flow"] == BASELINE}
    for row in rows:
        reference = base.get((row["scene"], row["sensor"]))
        if reference is not None:
            row |= {"px share": row["px"] / reference["px"], "cm share": row["cm"] / reference["cm"]}
    return rows
