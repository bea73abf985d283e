"""Families: what may stand in their files, and what is refused before anything is searched for."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from recording.errors import InputError
from simulator.family import DEVELOPMENT_SEEDS, REPORTING_SEEDS, Family, family_names, load_family
from simulator.family_scene import drawn_scene
from simulator.family_setting import drawn_setting
from simulator.recorded_crowd import crowd_tracks

SMALL: dict[str, Any] = {"name": "small", "frames": 30, "people": {"count": 2}}
A_WALL = {"walls": {"count": 1, "width_m": [0.8, 2], "height_m": 2.2}}


def family_of(**changes: Any) -> Family:
    return Family.model_validate(SMALL | changes)


def test_three_families_come_with_the_program_and_each_has_a_wish() -> None:
    assert family_names() == ["crowded", "dense", "sparse"]
    assert all(load_family(name).occlusion is not None for name in family_names())


def test_the_seeds_for_development_and_for_reporting_are_apart() -> None:
    assert not set(DEVELOPMENT_SEEDS) & set(REPORTING_SEEDS)
    assert 999 in DEVELOPMENT_SEEDS
    assert 1000 in REPORTING_SEEDS


def test_one_number_is_a_range_and_one_sensor_a_choice() -> None:
    family = family_of(sensor={"preset": "ideal"})
    assert family.people.count == (2, 2)
    assert len(family.sensor) == 1


def test_a_family_is_read_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text('name = "mine"\n[people]\ncount = [2, 3]\n', encoding="utf-8")
    assert load_family(path).people.count == (2, 3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[people]\ncount = 2\n", "key 'name' is missing"),
        ('name = "a"\n[people]\ncount = 2\nsped = 1\n', "unknown key 'people.sped', did you mean 'speed'"),
        ('name = "a"\n[people]\ncount = [3, 2]\n', r"people.count: expected a range \[lowest, highest\]"),
        ('name = "a"\n[people]\ncount = 2\nspeed = 2.4\n', "people: expected a 'speed' up to 1.9"),
        ('name = "a"\n[people]\ncount = 2\ndepth_m = 3\ndensity = 1\n', "either 'depth_m' or 'density'"),
    ],
)
def test_a_wrong_file_is_refused_by_its_key(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=message):
        load_family(path)


def test_an_unknown_name_names_the_nearest_one() -> None:
    with pytest.raises(InputError, match="did you mean 'crowded'"):
        load_family("crowed")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"people": {"count": 12, "density": 6}}, r"expected room for 12 people who keep 0.6 m apart, got 2 square"),
        ({"camera": {"distance_m": 3}, "people": {"count": 2, "depth_m": 4}}, "begins at 1.00 m"),
        ({"occlusion": {"hole_frames": 40}}, "into 30 frames"),
        ({"occlusion": {"hole_frames": 9, "by": "obstacles"}}, "expected obstacles"),
        ({"people": {"count": 1}, "occlusion": {"hole_frames": 9}}, "somebody else who hides"),
        ({"occlusion": {"hole_frames": 20, "hidden_share": 0.1}}, "one hole of 20 frames at least, 0.250"),
        ({"occlusion": {"hole_frames": 5, "hidden_share": 0.6, "by": "people"}}, "up to 0.42"),
    ],
)
def test_an_impossible_wish_is_refused_by_arithmetic_in_one_line(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message) as refused:
        drawn_setting(family_of(**changes), np.random.default_rng(1))
    assert "\n" not in str(refused.value)


def test_a_wish_that_no_scene_meets_is_refused_with_the_nearest_found() -> None:
    family = family_of(
        frames=20,
        people={"count": 3},
        occlusion={"hole_frames": 16, "spread": 0.05, "hidden_share": 0.5, "by": "people"},
    )
    with pytest.raises(InputError, match=r"expected holes of 16 frames and 0.5 hidden by people, the nearest found"):
        drawn_scene(family, 1)


def with_walks(folder: Path, content: str = "1 0 0 0\n1 9 1 0\n") -> Path:
    """A family of recorded people in the folder, its crowd's file in one below."""
    (folder / "sub").mkdir(parents=True)
    (folder / "sub" / "walks.txt").write_text(content, encoding="utf-8")
    path = folder / "yard.toml"
    path.write_text('name = "yard"\n[people]\ncount = 1\n[crowd]\nfile = "sub/walks.txt"\nfps = 10\n', encoding="utf-8")
    return path


def test_a_recorded_crowd_is_known_by_its_content_wherever_it_lies(tmp_path: Path) -> None:
    here, there = (load_family(with_walks(tmp_path / name)) for name in ("here", "there"))
    other = load_family(with_walks(tmp_path / "other", "1 0 0 0\n1 9 2 0\n"))
    documents = [family.model_dump(mode="json") for family in (here, there, other)]
    assert documents[0]["crowd"]["file"] == "sub/walks.txt"
    assert documents[0] == documents[1]
    assert documents[0] != documents[2]


def test_a_crowds_file_that_has_changed_or_is_missing_is_refused_in_one_line(tmp_path: Path) -> None:
    family = load_family(with_walks(tmp_path / "a"))
    assert family.crowd is not None
    (tmp_path / "a" / "sub" / "walks.txt").write_text("1 0 0 0\n1 9 3 0\n", encoding="utf-8")
    with pytest.raises(
        InputError, match=r"walks\.txt: expected the file with the SHA-256 .* leave 'sha256' out"
    ) as one:
        crowd_tracks(family.crowd)
    (tmp_path / "a" / "sub" / "walks.txt").unlink()
    with pytest.raises(InputError, match=r"walks\.txt: expected a readable text file of trajectories") as two:
        load_family(tmp_path / "a" / "yard.toml")
    assert "\n" not in f"{one.value}{two.value}"


def test_a_family_built_in_python_looks_for_its_crowd_below_the_working_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with_walks(tmp_path / "a")
    monkeypatch.chdir(tmp_path / "a")
    family = family_of(crowd={"file": "sub/walks.txt", "fps": 10})
    assert family.crowd is not None
    assert len(crowd_tracks(family.crowd).tracks) == 1


def test_a_negative_seed_is_refused() -> None:
    with pytest.raises(InputError, match="expected a seed of 0"):
        drawn_scene(family_of(), -1)
