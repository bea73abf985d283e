"""Errors of flows between photographs with known flow; `flow.py` prints them for the folder of `--middlebury`."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import cv2
import numpy as np
from jaxtyping import Bool, Float, Float32, UInt8

from algorithm.flow import photograph_flow_b_from_a
from algorithm.settings import PixelFlowName
from benchmarks.tables import Row, mean_row
from recording.errors import InputError
from recording.progress import tracked

_UNKNOWN_PX = 1e9
"""In a flow file a larger component means that the flow is not known."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PhotographPair:
    """Two photographs and how the first moves to the second."""

    name: str
    first: UInt8[np.ndarray, "row column rgb=3"]
    second: UInt8[np.ndarray, "row column rgb=3"]
    flow: Float32[np.ndarray, "row column 2"]
    """Columns, rows, in pixels."""
    known: Bool[np.ndarray, "row column"]
    """False where the flow was not measured."""


def middlebury_rows(folder: Path, flows: Sequence[str]) -> list[Row]:
    """A row a flow and pair of photographs, and after them the mean of each flow over the pairs.

    End-point error in pixels, angular error in degrees, seconds of one core. The flows run on one thread.
    """
    for flow in flows:
        if flow not in get_args(PixelFlowName):
            raise InputError(f"--flows: unknown flow {flow!r}: expected one of {', '.join(get_args(PixelFlowName))}")
    pairs = middlebury_pairs(folder)
    cv2.setNumThreads(1)
    rows: list[Row] = []
    for flow in tracked(flows, "flows", total=len(flows)):
        _flow_and_seconds(_corner(pairs[0]), flow)  # Compiled now, not on the clock.
        own = [_row(pair, flow) for pair in pairs]
        rows += [*own, {**mean_row(own), "flow": flow, "pair": "mean"}]
    return rows


def middlebury_pairs(folder: Path) -> list[PhotographPair]:
    """The pairs of a folder laid out as the training set of vision.middlebury.edu/flow: a folder each.

    Each with `frame10.png`, `frame11.png` and `flow10.flo`, in which what is not known is above 1e9.
    """
    homes = sorted(path.parent for path in folder.glob("*/flow10.flo"))
    if not homes:
        raise InputError(f"{folder}: expected folders with frame10.png, frame11.png and flow10.flo; found none")
    return [_pair(home) for home in homes]


def _pair(home: Path) -> PhotographPair:
    photographs = [cv2.imread(str(home / name), cv2.IMREAD_COLOR) for name in ("frame10.png", "frame11.png")]
    flow = np.asarray(cv2.readOpticalFlow(str(home / "flow10.flo")), np.float32)
    if flow.ndim != 3 or any(
        photograph is None or photograph.shape[:2] != flow.shape[:2] for photograph in photographs
    ):
        raise InputError(f"{home}: expected two pictures of the flow's size; make frame10.png and frame11.png such")
    first, second = (cv2.cvtColor(photograph, cv2.COLOR_BGR2RGB) for photograph in photographs)
    known = (np.abs(flow) < _UNKNOWN_PX).all(axis=-1)
    return PhotographPair(name=home.name, first=first, second=second, flow=flow, known=known)


def endpoint_errors(
    found: Float32[np.ndarray, "row column 2"], pair: PhotographPair
) -> Float[np.ndarray, "known_pixel"]:
    """The distances, in pixels, between where the flow leads and where it should."""
    return np.linalg.norm(found[pair.known] - pair.flow[pair.known], axis=-1)


def angular_errors(
    found: Float32[np.ndarray, "row column 2"], pair: PhotographPair
) -> Float[np.ndarray, "known_pixel"]:
    """The angles, in degrees, between the flows as directions (u, v, 1) in space-time [Barron et al., IJCV 1994]."""
    one, other = (
        np.pad(flow[pair.known].astype(np.float64), ((0, 0), (0, 1)), constant_values=1) for flow in (found, pair.flow)
    )
    cosine = (one * other).sum(axis=-1) / np.linalg.norm(one, axis=-1) / np.linalg.norm(other, axis=-1)
    return np.degrees(np.arccos(cosine.clip(-1, 1)))


def _row(pair: PhotographPair, flow: PixelFlowName) -> Row:
    found, seconds = _flow_and_seconds((pair.first, pair.second), flow)
    return {
        "flow": flow,
        "pair": pair.name,
        "end-point px": float(endpoint_errors(found, pair).mean()),
        "angular deg": float(angular_errors(found, pair).mean()),
        "seconds": seconds,
    }


def _flow_and_seconds(photographs: tuple[np.ndarray, np.ndarray], flow: PixelFlowName) -> tuple[np.ndarray, float]:
    begun = time.process_time()
    found = photograph_flow_b_from_a(*photographs, method=flow)
    return found, time.process_time() - begun


def _corner(pair: PhotographPair) -> tuple[np.ndarray, np.ndarray]:
    return pair.first[:64, :64], pair.second[:64, :64]
