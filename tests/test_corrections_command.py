"""`solve --corrections`: what was said by hand is respected; what is wrong with it is one line and exit status 2."""

from pathlib import Path

import numpy as np
import pytest
from worlds import recorded, sphere

import unocclude
from unocclude import Anchor, Correction, Corrections


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A ball passes behind another."""
    near = sphere(lambda frame: (0.1, 0, 1.5), 0.25)
    far = sphere(lambda frame: (-0.9 + 0.12 * frame, 0, 2.5), 0.3)
    folder = tmp_path_factory.mktemp("recordings") / "balls"
    unocclude.save_recording(recorded([near, far], frames=16, moving=[False, True]), folder)
    return folder


def solve(place: Path, *arguments: object) -> int:
    """The exit status of `solve`."""
    words = ["solve", place, "--set", "eps4=3", "--overwrite", *arguments]
    try:
        unocclude.main([str(word) for word in words])
    except SystemExit as stop:
        return int(stop.code or 0)
    return 0


def test_corrections_are_respected_and_told_of_in_the_result(
    place: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert solve(place) == 0
    motions = unocclude.load_motions(place / "motions.parquet")
    assert (len(motions.motion_ids), motions.making.corrections) == (1, None)
    (link,) = motions.links
    marks = []
    for segment in (link.before, link.after):
        row = np.flatnonzero(motions.observed & (motions.segment == segment))[0]
        column, line = motions.column_row[row].tolist()
        marks.append(Anchor(frame=int(motions.frame[row]), column=column, row=line, segment=segment))
    said = Corrections(
        recording_digest=unocclude.load_recording(place).digest(),
        correction=(Correction(kind="different", one=marks[0], other=marks[1]),),
    )
    unocclude.save_corrections(said, tmp_path / "corrections.toml")
    assert solve(place, "--corrections", tmp_path / "corrections.toml") == 0
    mended = unocclude.load_motions(place / "motions.parquet")
    assert (len(mended.motion_ids), mended.making.corrections) == (2, said)
    assert ", with 1 correction by hand" in capsys.readouterr().err
    with pytest.raises(SystemExit, match="0"):
        unocclude.main(["evaluate", str(place)])
    assert capsys.readouterr().out.splitlines()[-1] == "corrections     1 by hand"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ('recording_digest = "abc"', "those of another one"),
        ("recording = 1", "'recording_digest' is missing"),
        ('recording_digest = "DIGEST"\ncorection = []', "did you mean 'correction'?"),
        (
            'recording_digest = "DIGEST"\n[[correction]]\nkind = "same"\n'
            "one = { frame = 2, column = 1, row = 1 }\nother = { frame = 3, column = 1, row = 1 }",
            "correction 1 (same): one: expected a point of a segment",
        ),
    ],
)
def test_wrong_corrections_are_one_line(
    place: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, sentence: str
) -> None:
    path = tmp_path / "corrections.toml"
    path.write_text(text.replace("DIGEST", unocclude.load_recording(place).digest()), encoding="utf-8")
    assert solve(place, "--corrections", path) == 2
    error = capsys.readouterr().err
    assert sentence in error
    assert len(error.strip().splitlines()) == 1


def test_the_preset_paper_knows_no_corrections(place: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    said = Corrections(recording_digest=unocclude.load_recording(place).digest())
    unocclude.save_corrections(said, tmp_path / "corrections.toml")
    assert solve(place, "--corrections", tmp_path / "corrections.toml", "--preset", "paper") == 2
    assert "completing = 'continuation'" in capsys.readouterr().err
