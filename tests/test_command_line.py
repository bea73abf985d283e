"""The command line: the whole path, and one clear line with exit status 2 for what is wrong."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
from small_scenes import PASSING
from worlds import recorded, small_camera, sphere

import unocclude
from recording.recording import stripped

ROOT = Path(__file__).parent.parent


def run(*arguments: object) -> int:
    """The exit status of a command line."""
    try:
        unocclude.main([str(argument) for argument in arguments])
    except SystemExit as stop:
        return int(stop.code or 0)
    return 0


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small recording that was simulated and solved by the command line."""
    folder = tmp_path_factory.mktemp("recordings")
    (folder / "small.toml").write_text(PASSING, encoding="utf-8")
    assert run("simulate", folder / "small.toml", "-o", folder, "--backend", "scalar", "--quiet") == 0
    assert run("solve", folder / "small", "--quiet", "--set", "eps4=3") == 0
    return folder / "small"


def test_simulate_solve_and_evaluate_make_scores_under_the_contracts_keys(
    solved: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("evaluate", solved, "--json") == 0
    scores = json.loads(capsys.readouterr().out)
    assert list(scores) == [
        *("scene", "frames", "objects", "points_per_frame", "holes", "longest_hole_frames", "coverage"),
        *("trajectories", "segments", "motions", "identity", "completion", "links", "events", "calibration"),
        *("seconds", "version", "preset"),
    ]
    assert scores["objects"] == 1
    assert scores["preset"] == "default"


def test_verify_passes_what_was_simulated_and_fails_what_was_changed(solved: Path, tmp_path: Path) -> None:
    assert run("verify", solved) == 0
    recording = unocclude.load_recording(solved)
    document = json.loads((solved / "recording.json").read_text(encoding="utf-8"))
    document["camera"]["cx"] += 2.0
    unocclude.save_recording(recording, tmp_path / "moved")
    (tmp_path / "moved" / "recording.json").write_text(json.dumps(document), encoding="utf-8")
    assert run("verify", tmp_path / "moved") == 1


def test_verify_prints_the_digest_also_of_a_recording_without_truth(
    solved: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = unocclude.load_recording(solved)
    assert run("verify", solved) == 0
    assert capsys.readouterr().out.splitlines()[-1] == f"digest: {recording.digest()}"
    unocclude.save_recording(stripped(recording), tmp_path / "bare")
    assert run("verify", tmp_path / "bare", "--digest") == 0
    assert capsys.readouterr().out == f"{recording.digest()}\n"


def test_seconds_are_those_without_the_cache_where_stages_came_from_it(
    solved: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("solve", solved, "-o", tmp_path / "m.parquet", "--cache", tmp_path / "cache", "--overwrite")
    assert run(*words) == 0
    assert re.search(r" motions? in \d+\.\d s\b(?! \()", capsys.readouterr().err)
    assert run(*words) == 0
    again = re.search(r" in \d+\.\d s \((\d+\.\d s without the cache)\)", capsys.readouterr().err)
    assert again is not None
    assert run("evaluate", solved, tmp_path / "m.parquet") == 0
    assert f"time            {again[1]}, of it flow" in capsys.readouterr().out


def test_nothing_of_the_truth_leaks_into_the_solver(solved: Path) -> None:
    recording = unocclude.load_recording(solved)
    stripped = unocclude.Recording(
        metadata=recording.metadata.model_copy(update={"objects": None, "scene": None, "seed": None}),
        frames=tuple(type(frame)(depth=frame.depth) for frame in recording.frames),
    )
    whole, bare = unocclude.solve(recording), unocclude.solve(stripped)
    for column in ("frame", "trajectory", "position", "motion", "source"):
        np.testing.assert_array_equal(getattr(whole, column), getattr(bare, column))


def test_results_are_not_overwritten_unless_asked_for(solved: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = (solved / "motions.parquet").read_bytes()
    assert run("solve", solved) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert (solved / "motions.parquet").read_bytes() == before


def test_what_solving_takes_is_said_before_and_refused_where_it_is_too_much(
    solved: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    again = ("-o", tmp_path / "again.parquet")
    assert run("solve", solved, *again, "--max-memory", "10MB") == 2
    assert "expected to need 0.01 GB of memory at most" in capsys.readouterr().err
    assert run("solve", solved, *again, "--max-memory", "much") == 2
    assert "--max-memory: expected a size such as 4GB" in capsys.readouterr().err
    assert not any(tmp_path.iterdir())
    assert run("solve", solved, *again, "--max-memory", "4GB", "--set", "eps4=3") == 0
    assert "moving points in each: about" in capsys.readouterr().err
    assert again[1].is_file()


def test_with_less_memory_fewer_points_are_followed(
    solved: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    needed = unocclude.estimated(unocclude.load_recording(solved), memory_bytes=10**9).memory_bytes
    fewer = ("-o", tmp_path / "fewer.parquet", "--max-memory", f"{needed - 1000:.0f}B")
    assert run("solve", solved, *fewer, "--set", "eps4=3") == 0
    assert "one point in 4 is kept" in capsys.readouterr().err
    few, many = unocclude.load_motions(fewer[1]), unocclude.load_motions(solved / "motions.parquet")
    assert 0 < len(few) < len(many) / 2
    assert few.making.settings["points_apart_px"] == 2


def test_methods_are_compared_side_by_side(solved: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "small.parquet").write_bytes((solved / "motions.parquet").read_bytes())
    arguments = (solved, "--methods", "tracker", "gap_closing", "--motions", f"mine={tmp_path / 'mine'}")
    assert run("compare", *arguments, "-o", tmp_path / "out") == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()[3:6]] == ["tracker", "gap_closing", "mine"]
    assert run("compare", *arguments, "-o", tmp_path / "out", "--json") == 0
    document = json.loads(capsys.readouterr().out)
    assert list(document["groups"]["small"]) == ["tracker", "gap_closing", "mine"]
    assert document["failures"] == []


def test_pictures_are_drawn(solved: Path, tmp_path: Path) -> None:
    for command, name in (("draw", "overview.png"), ("draw", "overview.svg"), ("contact-sheet", "sheet.png")):
        assert run(command, solved, "-o", tmp_path / name, "--quiet") == 0
        assert (tmp_path / name).stat().st_size > 5000
    height, width, _ = cv2.imread(str(tmp_path / "overview.png")).shape
    assert width > height > 400


def test_images_are_imported_and_solved(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ball = recorded([sphere(lambda frame: (-0.5 + 0.05 * frame, 0, 2), 0.3)], frames=15, moving=[True])
    images = tmp_path / "images"
    images.mkdir()
    for number, frame in enumerate(ball.frames):
        cv2.imwrite(str(images / f"depth_{number}.png"), np.nan_to_num(frame.depth * 1000).astype(np.uint16))
    camera = small_camera()
    focal = ("--fx", camera.fx, "--fy", camera.fy, "--cx", camera.cx - 0.5, "--cy", camera.cy - 0.5)
    place = tmp_path / "ball"
    assert run("import", images, "--pattern", "depth_*.png", *focal, "--fps", 30, "-o", place) == 0
    assert run("solve", place) == 0
    said = capsys.readouterr().err
    assert "imported 15 frames" in said
    assert "1 motion in" in said
    motions = unocclude.load_motions(place / "motions.parquet")
    assert len(motions.motion_ids) == 1


WRONG = {
    "no such command": ("frob",),
    "no such option": ("solve", "{recording}", "--presett", "paper"),
    "no such preset": ("solve", "{recording}", "--preset", "best"),
    "no such setting": ("solve", "{recording}", "--set", "eps9=1", "--overwrite"),
    "impossible setting": ("solve", "{recording}", "--set", "eps1=-1", "--overwrite"),
    "setting without value": ("solve", "{recording}", "--set", "eps1", "--overwrite"),
    "no recording": ("solve", "{empty}"),
    "no motions": ("evaluate", "{recording}", "{empty}/motions.parquet"),
    "no scene": ("simulate", "wal", "-o", "{empty}"),
    "no scenes": ("simulate", "-o", "{empty}"),
    "no frames": ("simulate", "wall", "-o", "{empty}", "--frames", "0"),
    "no size": ("simulate", "wall", "-o", "{empty}", "--size", "big"),
    "no workers": ("simulate", "wall", "-o", "{empty}", "--workers", "0"),
    "no images": ("import", "{empty}", "--fx", 1, "--fy", 1, "--cx", 1, "--cy", 1, "--fps", 1, "-o", "{empty}/x"),
    "no such family": ("generate", "crowdy", "--count", "2", "-o", "{empty}/set"),
    "no recordings": ("generate", "crowded", "--count", "0", "-o", "{empty}/set"),
    "no count": ("generate", "crowded", "-o", "{empty}/set"),
    "no picture": ("draw", "{recording}", "-o", "{empty}/picture.doc"),
    "no row of the table": ("table1", "--scenes", "walls"),
    "no such figure": ("figure", "2", "-o", "{empty}/figures"),
    "no figure": ("figure", "-o", "{empty}/figures"),
    "nothing to compare": ("compare", "-o", "{empty}/x"),
    "no such method": ("compare", "{recording}", "--methods", "default,trackr", "-o", "{empty}/x"),
    "motions without a name": ("compare", "{recording}", "--motions", "{empty}", "-o", "{empty}/x"),
    "motions under one name twice": (
        *("compare", "{recording}", "--motions", "mine={empty}", "--motions", "mine={recording}"),
        *("-o", "{empty}/x"),
    ),
    "no method twice": ("compare", "{recording}", "--methods", "tracker,tracker", "-o", "{empty}/x"),
    "nothing to report": ("report", "{empty}"),
    "no page": ("report", "{recording}", "-o", "{empty}/page.pdf"),
    "no video": ("report", "{recording}", "--video", "{empty}/video.avi"),
    "a video of no recording": ("report", "{empty}", "--video", "{empty}/video.gif"),
    "motions that are not there": ("compare", "{recording}", "--motions", "mine={empty}", "-o", "{empty}/x"),
}


@pytest.mark.parametrize("what", WRONG)
def test_wrong_input_gets_one_line_and_status_2(
    what: str, solved: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = [str(part).format(recording=solved, empty=tmp_path) for part in WRONG[what]]
    assert run(*arguments) == 2
    output = capsys.readouterr()
    assert output.err.startswith("unocclude: ")
    assert output.err.count("\n") == 1
    assert output.out == ""
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("words", "advice"),
    [
        ("solve x --eps3 3", "pass --set eps3=3"),
        ("solve x --eps3=3 --quiet", "pass --set eps3=3"),
        ("solve x --remove-static", "pass --set remove_static=VALUE"),
        ("evaluate x --eps3 3", "run 'unocclude solve' with --set eps3=3"),
    ],
)
def test_an_option_that_is_a_setting_is_answered_with_how_to_set_it(
    words: str, advice: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(*words.split()) == 2
    assert capsys.readouterr().err.endswith(f": it is a setting of the solver: {advice}\n")


@pytest.mark.parametrize(
    "command",
    [
        "demo",
        "simulate",
        "generate",
        "resense",
        "import",
        "solve",
        "evaluate",
        "verify",
        "draw",
        "contact-sheet",
        "table1",
        "figure",
        "compare",
        "report",
        "export",
        "doctor",
    ],
)
def test_every_command_has_help_with_an_example(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(command, "--help") == 0
    assert f"Example: unocclude {command}" in " ".join(capsys.readouterr().out.split())


def test_solves_help_lists_every_setting(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("solve", "--help") == 0
    text = capsys.readouterr().out
    assert all(name in text for name in unocclude.Settings.model_fields)


def test_doctor_names_the_backend(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("doctor") == 0
    assert "rendering backend: " in capsys.readouterr().out


def test_ctrl_c_while_importing_is_one_line_and_status_130(tmp_path: Path) -> None:
    (tmp_path / "cyclopts.py").write_text("raise KeyboardInterrupt", encoding="utf-8")  # As if pressed right then.
    environment = os.environ | {"PYTHONPATH": str(tmp_path)}
    ended = _ended("-m", "unocclude", "doctor", env=environment)
    assert (ended.returncode, ended.stdout) == (130, "")
    assert ended.stderr == "unocclude: interrupted; nothing half-written is left\n"


def test_a_benchmark_ends_as_a_command_does(tmp_path: Path) -> None:
    ended = _ended("benchmarks/flow.py", "--middlebury", str(tmp_path))
    assert (ended.returncode, ended.stdout) == (2, "")
    assert ended.stderr.startswith(f"flow.py: {tmp_path}: expected folders")
    assert ended.stderr.count("\n") == 1


def _ended(*arguments: str, env: dict[str, str] | None = None) -> subprocess.CompletedProcess[str]:
    """How a Python program of this project ended."""
    return subprocess.run([sys.executable, *arguments], cwd=ROOT, env=env, capture_output=True, text=True, check=False)
