"""What a sweep's file asks for."""

from pathlib import Path

import pytest

from algorithm.settings import Settings, preset_settings
from evaluation.sweeps.plan import Sweep, load_sweep, points_of, settings_at
from recording.errors import InputError

SWEEPS = Path(__file__).parents[3] / "sweeps"
HEAD = 'name = "some"\nscenes = ["wall"]\n'


def written(folder: Path, text: str) -> Path:
    path = folder / "sweep.toml"
    path.write_text(text, encoding="utf-8")
    return path


def sweep_of(axes: dict[str, object], **changes: object) -> Sweep:
    return Sweep.model_validate({"name": "some", "scenes": ["wall"], "axes": axes, **changes})


def values_of(sweep: Sweep) -> list[dict[str, object]]:
    return [dict(point.values) for point in points_of(sweep)]


def test_a_list_is_taken_as_it_is() -> None:
    assert values_of(sweep_of({"flow": ["dis", "range"]})) == [{"flow": "dis"}, {"flow": "range"}]


def test_a_range_has_equal_steps_or_equal_ratios() -> None:
    linear = sweep_of({"eps1": {"from": 1, "to": 2, "steps": 5}})
    assert [point["eps1"] for point in values_of(linear)] == [1.0, 1.25, 1.5, 1.75, 2.0]
    ratios = sweep_of({"eps1": {"from": 0.1, "to": 10, "steps": 3, "scale": "logarithmic"}})
    assert [point["eps1"] for point in values_of(ratios)] == [0.1, 1.0, 10.0]


def test_a_grid_has_all_combinations() -> None:
    points = points_of(sweep_of({"eps1": [1.0, 2.0], "eps2": [0.1, 0.2, 0.3]}))
    assert [point.number for point in points] == list(range(6))
    assert len({tuple(point.values.items()) for point in points}) == 6


def test_one_at_a_time_leaves_the_other_axes_to_the_preset() -> None:
    points = points_of(sweep_of({"eps1": [1.0, 2.0], "eps2": [0.1]}, design="one_at_a_time"))
    assert [(point.axis, dict(point.values)) for point in points] == [
        (None, {}),
        ("eps1", {"eps1": 1.0}),
        ("eps1", {"eps1": 2.0}),
        ("eps2", {"eps2": 0.1}),
    ]


@pytest.mark.parametrize("design", ["sobol", "random"])
def test_samples_lie_in_their_ranges_and_are_the_same_each_time(design: str) -> None:
    axes = {
        "eps1": {"from": 1, "to": 2},
        "eps3": {"from": 0.1, "to": 10, "scale": "logarithmic"},
        "flow": ["dis", "range"],
    }
    sweep = sweep_of(axes, design=design, samples=24)
    points = values_of(sweep)
    assert len(points) == 24
    assert all(1 <= point["eps1"] <= 2 and 0.1 <= point["eps3"] <= 10 for point in points)
    assert {point["flow"] for point in points} == {"dis", "range"}
    assert 8 <= sum(point["eps3"] < 1 for point in points) <= 16
    assert points == values_of(sweep)
    assert points != values_of(sweep_of(axes, design=design, samples=24, sampling_seed=1))


def test_settings_that_count_take_whole_numbers_and_no_point_comes_twice() -> None:
    assert values_of(sweep_of({"shortest_frames": {"from": 2, "to": 4, "steps": 9}})) == [
        {"shortest_frames": frames} for frames in (2, 3, 4)
    ]


def test_a_point_changes_the_presets_values_and_the_sweeps_own() -> None:
    sweep = sweep_of({"eps1": [1.0]}, settings={"eps2": 0.3})
    settings = settings_at(sweep, points_of(sweep)[0], Settings(eps6=0.4))
    assert (settings.eps1, settings.eps2, settings.eps6) == (1.0, 0.3, 0.4)


def test_recordings_are_seen_from_the_file(tmp_path: Path) -> None:
    path = written(tmp_path, 'name = "some"\nrecordings = ["data"]\n[axes]\neps1 = [1]\n')
    assert load_sweep(path).recordings == (str(tmp_path / "data"),)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEAD, "key 'axes' is missing"),
        (HEAD + "[axes]\neps9 = [1]\n", r"axes: unknown key 'eps9', did you mean 'eps\d'"),
        (HEAD + "[axes]\neps1 = [-1]\n", "axes: eps1: input should be greater than 0, got -1"),
        (HEAD + "[axes]\neps1 = []\n", r"axes\.eps1\.values"),
        (HEAD + "[axes]\neps1 = {from = 1, to = 2}\n", "expected the number of steps of the range of 'eps1'"),
        (HEAD + "[axes]\neps1 = {from = 1}\n", "expected a list of values, or a range"),
        (HEAD + "[axes]\neps1 = {from = 0, to = 2, steps = 3, scale = 'logarithmic'}\n", "expected a range above 0"),
        (HEAD + "[axes]\neps1 = {frm = 1, to = 2}\n", "unknown key 'axes.eps1.frm', did you mean"),
        (HEAD + "[axes]\npreset = ['paper']\n", "a preset is many settings"),
        ('name = "some"\n[axes]\neps1 = [1]\n', "expected scenes or recordings"),
        (HEAD + "design = 'gird'\n[axes]\neps1 = [1]\n", "design: input should be 'grid'"),
        (HEAD + "settings = {eps9 = 1}\n[axes]\neps1 = [1]\n", "settings: unknown key 'eps9'"),
    ],
)
def test_what_is_wrong_is_said_in_one_sentence(text: str, message: str, tmp_path: Path) -> None:
    path = written(tmp_path, text)
    with pytest.raises(InputError, match=message) as raised:
        load_sweep(path)
    assert str(raised.value).startswith(f"{path}: ")
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("path", sorted(SWEEPS.glob("*.toml")), ids=lambda path: path.stem)
def test_the_sweeps_that_we_ship_ask_for_settings_that_there_are(path: Path) -> None:
    sweep = load_sweep(path)
    assert max(sweep.seeds) < 1000  # For development.
    for name, axis in sweep.axes.items():
        if axis.first is not None and axis.last is not None:
            assert axis.first <= getattr(preset_settings(sweep.preset), name) <= axis.last
