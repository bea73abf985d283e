"""Scores that show themselves are scores like any other."""

import json

import matplotlib.pyplot as plt
import pytest
from known import crossing, perfect
from matplotlib.figure import Figure
from wellformed import read

from evaluation.scorecard import Scorecard
from evaluation.scores import evaluate, scores
from recording.motions import Motions
from recording.recording import Recording, stripped


@pytest.fixture(scope="module")
def recording() -> Recording:
    return crossing()


@pytest.fixture(scope="module")
def motions(recording: Recording) -> Motions:
    return perfect(recording)


def test_a_scorecard_is_the_scores_as_a_dictionary(recording: Recording, motions: Motions) -> None:
    card = evaluate(recording, motions)
    assert card == scores(recording, motions)
    assert json.loads(json.dumps(card)) == dict(card)


def test_a_notebook_shows_its_lines(recording: Recording, motions: Motions) -> None:
    tags, texts = read(evaluate(recording, motions)._repr_html_())
    assert "table" in tags
    assert texts[texts.index("motions found") + 1].startswith("2 of 2")


def test_a_name_cannot_become_part_of_the_page(recording: Recording, motions: Motions) -> None:
    card = Scorecard(evaluate(recording, motions) | {"scene": "<script>alert(1)</script>"})
    assert "script" not in read(card._repr_html_())[0]


def test_bars_are_as_long_as_the_scores_and_none_where_there_is_none(recording: Recording, motions: Motions) -> None:
    known, unknown = (Figure().subplots() for _ in range(2))
    card, bare = evaluate(recording, motions), stripped(recording)
    card.plot(axes=known)
    assert known.patches[1].get_width() == card["motions"]["purity"]
    assert "2 of 2 found" in known.get_title(loc="right")
    evaluate(bare, motions).plot(axes=unknown)
    assert {bar.get_width() for bar in unknown.patches} == {0.0}
    assert {text.get_text() for text in unknown.texts} == {"-"}
    assert "no truth" in unknown.get_title(loc="right")


def test_one_call_makes_a_figure(recording: Recording, motions: Motions) -> None:
    plt.close(evaluate(recording, motions).plot().figure)
