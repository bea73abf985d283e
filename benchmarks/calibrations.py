"""Confidences of many recordings, pooled: in each tenth, how many claims and the share that holds."""

from collections.abc import Sequence

from benchmarks.tables import Row
from evaluation.calibration import Tenth, largest_miss, pooled, sure_share, tenths_from
from evaluation.outcome import Outcome

ENOUGH = 50
"""Claims in a tenth of confidence from which on its share says something."""
WHAT = {"links": "links", "completed": "points"}


def calibration_rows(outcomes: Sequence[Outcome]) -> list[Row]:
    """A row a tenth; then the largest miss over tenths with enough claims, and the share of right ones above .9."""
    together = {what: _pooled(outcomes, what) for what in WHAT}
    rows: list[Row] = []
    for parts in zip(*together.values(), strict=True):
        row: Row = {"confidence": f"{parts[0].begin:.1f} to {parts[0].end:.1f}"}
        for name, tenth in zip(WHAT.values(), parts, strict=True):
            row |= {name: tenth.count, f"{name} hold": tenth.share}
        rows.append(row)
    misses = {f"{WHAT[what]} hold": largest_miss(found, least=ENOUGH) for what, found in together.items()}
    sure = {f"{WHAT[what]} hold": sure_share(found) for what, found in together.items()}
    return [*rows, {"confidence": "off by, at the most"} | misses, {"confidence": "of the right, above .9"} | sure]


def _pooled(outcomes: Sequence[Outcome], what: str) -> tuple[Tenth, ...]:
    """The tenths of all recordings that have them as one."""
    calibrations = [one.scores["calibration"] for one in outcomes if one.scores is not None]
    return pooled(tenths_from(each[what]) for each in calibrations if each is not None)
