"""What a setting is judged by."""

from statistics import fmean

from evaluation.scores import Scores

WORTH = "worth"
ERROR = "error"
_LESS_IS_BETTER = ("_m", "seconds", "id_switches", "fragmentations", "over_segmented", ERROR)


def worth(flat: Scores) -> float | None:
    """(HOTA + recall) / 2 of the scores by dotted key: HOTA alone where nothing is hidden, None without truth.

    HOTA counts every frame in which somebody is in view, hidden or not, and recall asks for the points of the hidden.
    """
    hota, recall = flat.get("identity.hota"), flat.get("completion.recall")
    return None if hota is None else fmean([hota] if recall is None else [hota, recall])


def less_is_better(score: str) -> bool:
    """Whether a score, by its dotted key, is an error or a cost."""
    return score.startswith("seconds.") or score.endswith(_LESS_IS_BETTER)
