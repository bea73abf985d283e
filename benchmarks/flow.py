"""Optical flow against the truth: on simulated depth, or with --middlebury on photographs.

On depth each row is a scene, a sensor and a flow: end-point error of visible moving points in pixels and in
centimetres, by part of the body and by distance to an occlusion edge, milliseconds a pair both ways; some ten
minutes. On four pairs of photographs: end-point and angular error and seconds of one core; two minutes for all flows.
"""

import sys
from pathlib import Path
from typing import get_args

sys.path[0] = str(Path(__file__).parents[1])  # This folder's simulator.py would hide the package.

from cyclopts import App

from algorithm.settings import PixelFlowName
from benchmarks.flow_on_depth import depth_rows
from benchmarks.flow_on_photographs import middlebury_rows
from benchmarks.tables import run, show

app = App(help=__doc__)
_ON_DEPTH = ("deepflow:grey", "classic_nl_fast:grey", "dis:shading", "range")


@app.default
def flow(  # noqa: PLR0913 - as many as the table has dimensions.
    *,
    middlebury: Path | None = None,
    flows: str | None = None,
    scenes: tuple[str, ...] = ("wall", "forest", "9men"),
    seeds: tuple[int, ...] = (1001, 1002, 1003),
    sensors: tuple[str, ...] = ("ideal", "kinect1", "tof"),
    size: str = "240x180",
    json: bool = False,
) -> None:
    """Print the table.

    Args:
        middlebury: A folder of pairs laid out as on vision.middlebury.edu/flow, in place of simulated scenes.
        flows: Names with commas between, on depth with the image that the flow sees: `dis:shading,range`.
        scenes: Names of scenes.
        seeds: 1 to 20 are for development, 1001 to 1010 for reporting.
        sensors: Names of sensors.
        size: Picture size.
        json: One JSON object in place of the table.
    """
    chosen = flows.split(",") if flows else None
    if middlebury is not None:
        rows = middlebury_rows(middlebury, chosen or get_args(PixelFlowName))
        show(f"flow between the photographs of {middlebury}", rows, as_json=json)
    else:
        show(f"flow on depth, {size}", depth_rows(scenes, seeds, sensors, chosen or _ON_DEPTH, size=size), as_json=json)


if __name__ == "__main__":
    run(app)
