"""Data sets: the same bytes by any number of workers, whole recordings whatever happens, a manifest that is true."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from recording.causes import NOT_HIDDEN, OUT_OF_VIEW, causes_of
from recording.errors import InputError
from recording.manifest import load_manifest, recordings_of
from recording.store import load_recording
from recording.verify_set import verify_set
from recording.visibility import holes, visibility_of
from simulator.family import load_family
from simulator.generate import Generated, generate
from simulator.order import Order, split_of

FAMILY = """
name = "tiny"
frames = 4
fps = 10
[camera]
width = 48
height = 36
[people]
count = [1, 2]
"""
PROGRAM = """
import sys
from pathlib import Path
from simulator.family import load_family
from simulator.generate import generate
from simulator.order import Order
order = Order(family=load_family(Path(sys.argv[1])), folder=Path(sys.argv[2]))
generate(order, seeds=range(998, 1006), workers=2)
"""
CROWDED_OUT = "[people]\ncount = 12\nclearance_m = 3.0\ndensity = 1.0\n"


@pytest.fixture(scope="module")
def family(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("families") / "tiny.toml"
    path.write_text(FAMILY, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def made(family: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Generated]:
    """A data set of three recordings, made by one process."""
    folder = tmp_path_factory.mktemp("sets") / "one"
    return folder, generate(ordered(family, folder), seeds=range(998, 1001))


def ordered(family: Path, folder: Path, **changes: object) -> Order:
    return Order(family=load_family(family), folder=folder, **changes)


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_the_number_of_workers_changes_no_byte(made: tuple[Path, Generated], family: Path, tmp_path: Path) -> None:
    generate(ordered(family, tmp_path), seeds=range(998, 1001), workers=2)
    one = contents(made[0])
    assert len(one) == 3 * (4 + 4 + 2) + 1
    assert contents(tmp_path) == one


def test_the_manifest_says_what_the_recordings_hold(made: tuple[Path, Generated]) -> None:
    folder, done = made
    manifest = load_manifest(folder)
    assert manifest.recordings == done.recordings
    assert (done.kept, done.frames, done.refused, done.refusal) == (0, 12, (), None)
    assert [entry.name for entry in manifest.recordings] == ["tiny-000998", "tiny-000999", "tiny-001000"]
    assert [entry.split for entry in manifest.recordings] == ["development", "development", "reporting"]
    assert manifest.family.document["people"]["count"] == [1, 2]
    for entry in manifest.recordings:
        recording = load_recording(folder / entry.name)
        assert recording.digest() == entry.digest
        assert recording.metadata.name == entry.name
        assert recording.metadata.seed == entry.seed
        assert recording.metadata.scene_digest == entry.scene_digest
        assert recording.metadata.occlusion.achieved == entry.achieved
        assert len(recording.moving_ids) == entry.objects.people == entry.objects.moving


def test_what_was_achieved_is_what_the_files_show(made: tuple[Path, Generated]) -> None:
    for entry, recording in recordings_of(made[0], check=True):
        visibility, causes = visibility_of(recording), causes_of(recording)
        hidden = (causes.cause != NOT_HIDDEN) & (causes.cause != OUT_OF_VIEW)
        assert entry.achieved.object_frames == visibility.in_view.sum()
        assert entry.achieved.hidden_object_frames == visibility.hidden.sum() == hidden.sum()
        assert list(entry.achieved.hole_frames.lengths) == sorted(hole.frames for hole in holes(visibility))


def test_the_manifest_becomes_a_flat_table(made: tuple[Path, Generated]) -> None:
    document = json.loads((made[0] / "manifest.json").read_text(encoding="utf-8"))
    table = pd.json_normalize(document["recordings"])
    assert table["seed"].tolist() == [998, 999, 1000]
    assert {"objects.people", "achieved.hidden_share", "achieved.hole_frames.median"} <= set(table.columns)


def test_a_split_is_read_alone(made: tuple[Path, Generated]) -> None:
    assert [entry.seed for entry, _ in recordings_of(made[0], split="reporting")] == [1000]
    assert [split_of(seed) for seed in (0, 1, 999, 1000, 1999, 2000)] == [
        *("none", "development", "development", "reporting", "reporting", "none")
    ]


def test_the_same_call_keeps_what_is_there_and_makes_the_rest(
    made: tuple[Path, Generated], family: Path, tmp_path: Path
) -> None:
    generate(ordered(family, tmp_path), seeds=[999])
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "tiny-000999").rglob("*")}
    done = generate(ordered(family, tmp_path), seeds=range(998, 1001))
    assert (done.kept, done.frames) == (1, 8)
    assert {path: path.stat().st_mtime_ns for path in (tmp_path / "tiny-000999").rglob("*")} == before
    assert contents(tmp_path) == contents(made[0])


def test_at_a_url_stands_the_same_and_what_is_there_is_kept(
    made: tuple[Path, Generated], family: Path, tmp_path: Path
) -> None:
    order = Order(family=load_family(family), folder=f"file://{tmp_path}/set")
    generate(order, seeds=[999])
    assert generate(order, seeds=range(998, 1001)).kept == 1
    assert contents(tmp_path / "set") == contents(made[0])
    (tmp_path / "set" / "tiny-001000" / "recording.json").unlink()  # As if its making had been killed.
    assert generate(order, seeds=range(998, 1001)).kept == 2
    assert contents(tmp_path / "set") == contents(made[0])


def test_other_seeds_join_the_manifest(family: Path, tmp_path: Path) -> None:
    for seed in (8, 3):
        generate(ordered(family, tmp_path), seeds=[seed])
    assert [entry.seed for entry in load_manifest(tmp_path).recordings] == [3, 8]


def other_size(folder: Path, family: Path) -> Order:
    return ordered(family, folder, size="24x18")


def other_scene(folder: Path, family: Path) -> Order:
    (folder / "manifest.json").unlink()
    return other_size(folder, family)


def other_depths(folder: Path, family: Path) -> Order:
    frames = folder / "tiny-000003" / "frames"
    (frames / "000000.exr").write_bytes((frames / "000003.exr").read_bytes())
    return ordered(family, folder)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (other_size, r"manifest\.json: expected a data set of the same family, sensor and size"),
        (other_scene, r"tiny-000003: expected the recording of seed 3 .* got one of another scene"),
        (other_depths, r"tiny-000003: expected depths with the digest in manifest\.json, got others"),
    ],
)
def test_what_is_there_and_is_not_what_was_asked_for_is_replaced_only_on_demand(
    change: Callable[[Path, Path], Order], message: str, family: Path, tmp_path: Path
) -> None:
    generate(ordered(family, tmp_path), seeds=[3])
    order = change(tmp_path, family)
    with pytest.raises(InputError, match=message + ".*--overwrite"):
        generate(order, seeds=[3])
    again = Order(family=order.family, folder=tmp_path, size=order.size, overwrite=True)
    assert generate(again, seeds=[3]).kept == 0
    assert verify_set(tmp_path).passes


def test_a_sensor_in_place_of_the_familys_has_the_seeds_noise(family: Path, tmp_path: Path) -> None:
    generate(ordered(family, tmp_path, sensor="structured_light"), seeds=[1, 2])
    entries = load_manifest(tmp_path).recordings
    assert {entry.sensor for entry in entries} == {"structured_light"}
    sensors = [load_recording(tmp_path / entry.name).metadata.sensor for entry in entries]
    assert [sensor["seed"] for sensor in sensors] == [1, 2]


def test_a_family_without_room_leaves_nothing_behind(tmp_path: Path) -> None:
    path = tmp_path / "tiny.toml"
    path.write_text(FAMILY.partition("[people]")[0] + CROWDED_OUT, encoding="utf-8")
    done = generate(ordered(path, tmp_path / "set"), seeds=[4, 7])
    assert re.match(r"2 of 2 seeds have no scene \(4, 7\): ", done.refusal)
    assert "\n" not in done.refusal
    assert not (tmp_path / "set").exists()


def test_verify_says_what_is_wrong_with_which_recording(made: tuple[Path, Generated], tmp_path: Path) -> None:
    shutil.copytree(made[0], tmp_path / "set")
    swapped, cut = (tmp_path / "set" / name / "frames" for name in ("tiny-000998", "tiny-000999"))
    (swapped / "000000.exr").write_bytes((swapped / "000003.exr").read_bytes())
    (cut / "000002.exr").unlink()
    report = verify_set(tmp_path / "set", workers=2)
    assert not report.passes
    assert [finding.passes for finding in report.findings] == [False, False, True]
    lines = report.text.splitlines()
    assert re.match(r"FAIL tiny-000998: .* expected depths with the digest in manifest\.json", lines[0])
    assert re.match(r"FAIL tiny-000999: .*000002\.exr is missing", lines[1])
    assert lines[2:5] == ["ok   tiny-001000", "", "3 recordings, 2 of which fail; the largest error of each kind:"]
    assert any(line.startswith("ok   feet slide: ") for line in lines)


def test_a_data_set_of_recorded_people_goes_on_with_its_family_elsewhere(family: Path, tmp_path: Path) -> None:
    crowd = '[crowd]\nfile = "walks.txt"\nfps = 10\n'
    walks = [f"{person} {frame} {0.1 * frame - 3} {1.2 * person}" for person in range(4) for frame in range(60)]
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "tiny.toml").write_text(family.read_text(encoding="utf-8") + crowd, encoding="utf-8")
        (tmp_path / name / "walks.txt").write_text("\n".join(walks), encoding="utf-8")
    here, there = (ordered(tmp_path / name / "tiny.toml", tmp_path / "set") for name in ("here", "there"))
    generate(here, seeds=[1])
    assert generate(there, seeds=[1]).kept == 1
    (tmp_path / "there" / "walks.txt").write_text("\n".join(walks[:-1]), encoding="utf-8")
    with pytest.raises(InputError, match="expected a data set of the same family"):
        generate(ordered(tmp_path / "there" / "tiny.toml", tmp_path / "set"), seeds=[2])
    with pytest.raises(InputError, match=r"walks\.txt: expected the file with the SHA-256"):
        generate(there, seeds=[2])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"sensor": "kinect"}, "unknown sensor 'kinect': did you mean 'kinect1'"),
        ({"size": "2.5x"}, "expected a picture size such as 640x480 or 2x, got '2.5x'"),
    ],
)
def test_what_no_seed_can_have_is_refused_before_any_scene_is_drawn(
    changes: dict[str, object], message: str, family: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[int] = []
    monkeypatch.setattr("simulator.order.drawn_scene", lambda _, seed: drawn.append(seed))
    with pytest.raises(InputError, match=message):
        generate(ordered(family, tmp_path / "set", **changes), seeds=[1, 2])
    assert not drawn
    assert not (tmp_path / "set").exists()


def test_a_seed_that_is_repeated_is_refused(family: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected every seed once, got seed 3 2 times"):
        generate(ordered(family, tmp_path), seeds=[3, 3])


def test_no_seed_is_refused(family: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="at least one seed"):
        generate(ordered(family, tmp_path), seeds=[])


def test_a_killed_run_leaves_whole_recordings_and_the_next_completes_them(
    made: tuple[Path, Generated], family: Path, tmp_path: Path
) -> None:
    place = tmp_path / "set"
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])}
    running = subprocess.Popen([sys.executable, "-P", "-c", PROGRAM, family, place], env=environment)
    while running.poll() is None and not list(place.glob("tiny-*")):
        time.sleep(0.005)
    running.send_signal(signal.SIGKILL)
    assert running.wait() == -signal.SIGKILL
    assert list(place.glob("tiny-*"))
    assert not (place / "manifest.json").exists()
    done = generate(ordered(family, place), seeds=range(998, 1006), workers=2)
    assert 0 < done.kept < 8
    assert [entry.seed for entry in load_manifest(place).recordings] == list(range(998, 1006))
    for entry in made[1].recordings:
        assert contents(place / entry.name) == contents(made[0] / entry.name)
    assert verify_set(place, workers=2).passes
