"""Every example runs alone, without a warning, says what it says in the text, and leaves its picture."""

import os
import re
import subprocess
import sys
from pathlib import Path

import cv2
import pytest

FOLDER = Path(__file__).parents[2] / "examples"
EXAMPLES = sorted(FOLDER.glob("*.py"))
SAID = {
    "1_simulate": [
        "<Recording wall: 100 frames of 192x144 pixels, 30 a second, 2 moving objects>",
        r"depth image \(144, 192\), from \d\.\d to \d\.\d m",
        r"person 1 is hidden in \d\d of 100 frames",
    ],
    "2_solve": ["<Motions: 2 motions, .* points", r"motion 1: .*% of them completed", r"motion 1: out of sight from"],
    "3_score": ["found: 2 of 2 people", "purity 1.00, inverse purity 1.00", r"hidden: recall 1.00, the centre \d cm"],
    "4_own_recording": [
        "60 images in depth/",
        "<Recording two balls: 60 frames of 160x120 pixels, 30 a second>",
        "<Motions: 2 motions",
        r"motion 1: .* points completed, confidence 0.\d\d",
    ],
    "5_sweep": [
        r"0.25 s: . of 2 found, recall 0\.",
        "1.00 s: 2 of 2 found, recall 1.00",
        r"the longest hole lasts 0\.\d\d s",
    ],
    "6_torch_dataset": [
        "36 clips of 2 recordings",
        r"depth: \(4, 3, 96, 128\)",
        r"motion: \(4, 96, 128, 3\)",
        r"fastest point: \d\.\d m/s",
    ],
}
"""What has to be among what an example prints."""


def test_the_examples_are_numbered_and_each_leads_to_the_next() -> None:
    assert [path.stem for path in EXAMPLES] == list(SAID)
    for number, path in enumerate(EXAMPLES[1:], 1):
        assert f"Next: [{path.name}]({path.name})" in EXAMPLES[number - 1].read_text(encoding="utf-8").replace(
            "\n# ", " "
        )


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_opens_as_a_notebook_and_its_links_lead_somewhere(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    cells = text.split("# %%")
    assert cells[0] == ""
    assert cells[1].startswith(f" [markdown]\n# # {path.stem[0]}. ")
    for cell in cells[1:]:
        kind, content = cell.split("\n", 1)
        lines = content.strip().splitlines()
        assert kind in ("", " [markdown]")
        assert not kind or all(line.startswith("#") for line in lines)
    for target in re.findall(r"\]\(([^)]+)\)", text):
        assert (FOLDER / target).is_file()


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs_alone_and_leaves_its_picture(path: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-W", "error", str(path)],
        cwd=tmp_path,
        env={**os.environ, "MPLBACKEND": "agg"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    for words in SAID[path.stem]:
        assert re.search(words, done.stdout), f"{words!r} is not in:\n{done.stdout}"
    picture = cv2.imread(str(tmp_path / "pictures" / f"{path.stem}.png"))
    assert picture is not None
    assert picture.std() > 10  # More than an empty sheet.
