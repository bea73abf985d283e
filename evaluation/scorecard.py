"""Scores that show themselves: as a table in a notebook, as bars when they are plotted."""

from typing import TYPE_CHECKING, Any

from evaluation.summary import summary_rows
from recording.markup import facts
from recording.palette import COLOURS

if TYPE_CHECKING:
    import matplotlib.axes

_BARS = {
    "coverage": "moving points in a motion",
    "motions.purity": "purity of motions",
    "motions.inverse_purity": "inverse purity of motions",
    "identity.hota": "HOTA",
    "identity.idf1": "IDF1",
    "links.precision": "precision of links",
    "links.recall": "recall of links",
    "completion.recall": "hidden frames completed",
    "completion.surface_coverage_10cm": "hidden surface within 10 cm",
    "completion.within_16cm": "hidden points within 16 cm",
}
"""Scores of which 1 is the best, by key."""


class Scorecard(dict[str, Any]):
    """The scores of `unocclude evaluate --json`: a dictionary like any other that can also be looked at."""

    def plot(self, axes: "matplotlib.axes.Axes | None" = None) -> "matplotlib.axes.Axes":
        """Draw the scores of which 1 is the best as bars, on new axes if none are given; "-" where there is none."""
        from recording.drawing import new_axes  # noqa: PLC0415 - matplotlib is slow to import.

        drawn = axes or new_axes(shape=0.55)
        shares = [self._share(key) for key in _BARS]
        bars = drawn.barh(list(_BARS.values()), [share or 0.0 for share in shares], color=COLOURS[0], height=0.7)
        drawn.bar_label(bars, ["-" if share is None else f"{share:.2f}" for share in shares], padding=3)
        drawn.set(xlim=(0, 1.1), xticks=[0, 0.25, 0.5, 0.75, 1], xlabel="score (1 is the best)")
        drawn.invert_yaxis()
        drawn.spines[["top", "right"]].set_visible(False)
        drawn.set_title(f"{self['scene'] or 'recording'}: {self._found()}", loc="right")
        return drawn

    def _share(self, key: str) -> float | None:
        value: Any = self
        for part in key.split("."):
            value = value[part]
        return value

    def _found(self) -> str:
        """How many objects were found, and how far off they are while hidden, as far as that is known."""
        found, error_m = self["motions"]["found"], self["completion"]["centre_mean_m"]
        if found is None:
            return f"{self['motions']['count']} motions, no truth to hold them against"
        hidden = "" if error_m is None else f", hidden ones {100 * error_m:.1f} cm off on average"
        return f"{found} of {self['objects']} found{hidden}"

    def _repr_html_(self) -> str:
        """The lines of `unocclude evaluate`, as a notebook shows them."""
        return str(facts(summary_rows(self)))
