"""Each sensor's statistics are those of its formula, and without noise it is exact; labels stay whatever it does."""

from typing import Any

import numpy as np
import pytest
from sensed_worlds import CAMERA, errors, sensed, wall

from recording.checks import validated
from recording.errors import InputError
from recording.frame import Reason
from simulator.kinect1 import Kinect1
from simulator.scene import Scene
from simulator.sensed import Scanner
from simulator.sensor import PRESETS, sensor_named
from simulator.simulate import simulate
from simulator.stereo import Stereo
from simulator.structured_light import StructuredLight
from simulator.tof import TimeOfFlight
from simulator.view import View

QUIET: dict[str, dict[str, Any]] = {
    "kinect1": {"disparity_step_px": 0, "axial_m": 0, "axial_growth_per_m": 0, "axial_slope_m": 0}
    | {"lateral_px": 0, "lateral_slope_px": 0, "window_px": 1, "grazing_deg": 90},
    "tof": {"noise_m": 0, "noise_growth_per_m": 0, "bias_m": 0, "wobble_m": 0, "lit_radius": 9, "rejected_share": 0},
    "structured_light": {"sigma_m": 0, "hole_share": 0},
    "stereo": {"disparity_sigma_px": 0, "disparity_step_px": 0, "window_px": 1},
}
KINDS: dict[str, type[Scanner]] = {
    "kinect1": Kinect1,
    "tof": TimeOfFlight,
    "structured_light": StructuredLight,
    "stereo": Stereo,
}
NEAR, FAR = 2.0, 4.0
BEFORE = wall(NEAR, -0.2, 0.2)
"""Before a farther wall: 28 columns of it."""


def quiet(preset: str, **changes: object) -> Any:
    """The sensor without any noise, but with what is changed."""
    return KINDS[preset].model_validate({"preset": preset} | QUIET[preset] | changes)


def share(reason: Reason, *frames: Any) -> float:
    return float(np.mean([frame.reason == reason for frame in frames]))


@pytest.mark.parametrize("preset", QUIET)
def test_without_noise_the_depth_is_exact(preset: str) -> None:
    assert np.nanmax(np.abs(errors(quiet(preset), wall(3.0, slope=0.3)))) < 1e-6


@pytest.mark.parametrize("preset", PRESETS)
def test_labels_and_exact_depth_are_the_ideal_sensors(preset: str) -> None:
    (noisy,), (exact,) = (sensed(sensor_named(name), BEFORE, wall(FAR)) for name in (preset, "ideal"))
    for name in ("objectid", "face", "u", "v"):
        np.testing.assert_array_equal(getattr(noisy.labels, name), getattr(exact.labels, name))
    np.testing.assert_array_equal(noisy.clean_depth, exact.depth)
    returns = np.isin(noisy.reason, (Reason.RETURN, Reason.MIXED))
    np.testing.assert_array_equal(noisy.seen, returns)


@pytest.mark.parametrize("preset", QUIET)
def test_nothing_returns_from_nothing_and_from_out_of_range(preset: str) -> None:
    sensor = KINDS[preset].model_validate({"preset": preset, "farthest_m": 3.5})
    (frame,) = sensed(sensor, BEFORE, wall(FAR, right=0.0))
    nothing = frame.labels.objectid == 0
    assert nothing.mean() > 0.3
    assert (frame.reason[nothing] == Reason.NOTHING_THERE).all()
    assert (frame.reason[frame.labels.objectid == 2] == Reason.OUT_OF_RANGE).all()


@pytest.mark.parametrize("preset", QUIET)
def test_the_same_seed_is_the_same_frame_and_another_one_another(preset: str) -> None:
    depths = [
        sensed(KINDS[preset].model_validate({"preset": preset, "seed": seed}), BEFORE, wall(FAR))[0].depth
        for seed in (3, 3, 4)
    ]
    np.testing.assert_array_equal(depths[0], depths[1])
    assert not np.array_equal(depths[0], depths[2], equal_nan=True)


@pytest.mark.parametrize("depth", [1.0, 2.0, 4.0])
def test_kinects_axial_noise_grows_with_the_square_of_the_distance(depth: float) -> None:
    sensor = quiet("kinect1", axial_m=0.0012, axial_growth_per_m=0.0019)
    noise = errors(sensor, wall(depth), frames=6)[:, 30:90, 40:120]  # Seen under less than 20 degrees.
    assert np.nanstd(noise) == pytest.approx(0.0012 + 0.0019 * (depth - 0.4) ** 2, rel=0.05)
    assert abs(np.nanmean(noise)) < 0.1 * np.nanstd(noise)


def test_kinects_axial_noise_grows_on_steep_surfaces() -> None:
    sensor, angle = Kinect1(preset="kinect1"), np.radians([[30.0, 70.0]])
    flat, steep = sensor.axial_sigma_m(np.full((1, 2), 2.0), angle)[0] - (0.0012 + 0.0019 * 1.6**2)
    assert flat == pytest.approx(0, abs=1e-12)
    assert steep == pytest.approx(0.0001 / np.sqrt(2) * np.radians(70) ** 2 / np.radians(20) ** 2)


def test_kinects_lateral_noise_moves_a_slope_as_far_as_it_says() -> None:
    slope, depth = 1.0, 3.0
    sensor = quiet("kinect1", lateral_px=0.8, lateral_slope_px=0.035, edge_px=99)
    middle = errors(sensor, wall(depth, slope=slope, left=-2.9), frames=8)[:, 30:90, 78:82]
    angle = np.pi / 4
    sigma_px = (0.8 + 0.035 * angle / (np.pi / 2 - angle)) * CAMERA.fx / sensor.focal_px
    assert np.nanstd(middle) == pytest.approx(sigma_px * slope * depth / CAMERA.fx, rel=0.1)


@pytest.mark.parametrize("preset", ["kinect1", "stereo"])
def test_depth_comes_in_steps_of_disparity(preset: str) -> None:
    sensor = quiet(preset, disparity_step_px=0.125)
    (frame,) = sensed(sensor, wall(4.0, slope=0.5))
    disparity = sensor.focal_px * sensor.baseline_m / frame.depth[frame.seen].astype(np.float64)
    np.testing.assert_allclose(disparity * 8, np.round(disparity * 8), atol=1e-4)
    steps = np.diff(np.unique(np.round(disparity * 8)))
    assert (steps == 1).all()


@pytest.mark.parametrize(("preset", "baseline"), [("kinect1", 0.075), ("kinect1", 0.15), ("stereo", 0.05)])
def test_a_shadow_is_as_wide_as_the_baseline_makes_it(preset: str, baseline: float) -> None:
    (frame,) = sensed(quiet(preset, baseline_m=baseline), BEFORE, wall(FAR))
    shadow = frame.reason == Reason.SHADOW
    width = CAMERA.fx * baseline * (1 / NEAR - 1 / FAR)
    assert shadow.sum(axis=1).mean() == pytest.approx(width, abs=0.51)
    assert (frame.labels.objectid[shadow] == 2).all()
    assert np.flatnonzero(shadow.any(axis=0)).max() < CAMERA.width / 2  # The light comes from the right.


def test_kinect_loses_what_its_window_shares_with_another_surface() -> None:
    sensor = quiet("kinect1", focal_px=CAMERA.fx, window_px=9, edge_share=0.7, baseline_m=0.3, farthest_m=99)
    (frame,) = sensed(sensor, wall(NEAR, left=0.0), wall(FAR))
    lost = (frame.reason == Reason.EDGE)[20:-20]
    own = frame.labels.objectid[20:-20] == 1
    # Of nine columns a pixel of the k-th one has 5 + k of its own surface: less than 0.7 of them for k = 0 and 1.
    assert np.sum(lost & own, axis=1).mean() == pytest.approx(2, abs=0.01)


def test_kinect_loses_every_second_pixel_at_the_grazing_angle() -> None:
    tilted = wall(3.0, slope=np.tan(np.radians(70)), left=-0.9)
    frames = sensed(quiet("kinect1", grazing_deg=70, grazing_soft_deg=0.5, edge_px=99), tilted, frames=12)
    middle = np.mean([frame.reason[55:65, 79:81] == Reason.GRAZING for frame in frames])
    assert middle == pytest.approx(0.5, abs=0.1)
    assert not (sensed(quiet("kinect1"), tilted)[0].reason == Reason.GRAZING).any()


@pytest.mark.parametrize("depth", [1.0, 3.5, 6.0])
def test_time_of_flights_noise_follows_distance_and_light(depth: float) -> None:
    sensor = quiet("tof", noise_m=0.001, noise_growth_per_m=0.0003, lit_radius=0.81, lit_border=0.075)
    noise = errors(sensor, wall(depth), frames=20)
    expected = 0.001 + 0.0003 * depth**2
    assert np.nanstd(noise[:, 50:70, 70:90]) == pytest.approx(expected, rel=0.05)
    assert expected <= 0.017
    ring = np.hypot(*(np.indices(noise.shape[1:]).T + 0.5 - (60, 80)).T) / 100
    border = (ring > 0.73) & (ring < 0.74)
    assert np.nanstd(noise[:, border]) == pytest.approx(expected * (1 + 10 * np.exp(-0.075 / 0.075)), rel=0.1)


def test_time_of_flights_corners_are_dark() -> None:
    frames = sensed(quiet("tof", lit_radius=0.81, lit_border=0.075), wall(3.0), frames=4)
    lost = np.mean([frame.reason == Reason.NO_SIGNAL for frame in frames], axis=0)
    ring = np.hypot(*(np.indices(lost.shape).T + 0.5 - (60, 80)).T) / 100
    assert lost[np.abs(ring - 0.81) < 0.01].mean() == pytest.approx(0.5, abs=0.05)
    assert lost[np.abs(ring - 0.885) < 0.01].mean() == pytest.approx(0.84, abs=0.05)
    assert lost[ring < 0.5].max() == 0
    assert 0.05 < lost.mean() < 0.25


def test_time_of_flights_frames_jump_as_a_whole_and_lost_pixels_do_not() -> None:
    noise = errors(quiet("tof", wobble_m=0.02, lit_radius=0.81), wall(3.0), frames=120)[:, ::8, ::8]
    jumps = np.nanmean(noise, axis=(1, 2))
    assert np.nanmax(np.abs(noise - jumps[:, None, None])) < 1e-5
    assert jumps.std() == pytest.approx(0.02, rel=0.25)
    assert abs(np.corrcoef(jumps[1:], jumps[:-1])[0, 1]) < 0.3
    assert np.isnan(noise).any()


def test_time_of_flights_bias_goes_up_and_down_with_the_distance() -> None:
    sensor = quiet("tof", bias_m=0.008, bias_period_m=0.4)
    found = [np.nanmean(errors(sensor, wall(depth), frames=1)) for depth in (2.0, 2.1, 2.2, 2.3)]
    assert found == pytest.approx([0, 0.008, 0, -0.008], abs=1e-5)


@pytest.mark.parametrize("spot", [1.0, 2.0])
def test_flying_pixels_lie_between_two_surfaces_as_often_as_the_spot_is_wide(spot: float) -> None:
    slanted = wall(NEAR, slope=0.0, left=0.0)
    slanted.vertices[0, :2, 0] += np.array([-3.0, 3.0], np.float32)  # Its edge passes all columns' parts alike.
    (frame,) = sensed(quiet("tof", spot_px=spot, farthest_m=99), slanted, wall(FAR))
    flying = frame.reason == Reason.MIXED
    rows = flying[10:-10].sum(axis=1).mean()
    slope = 6.0 / 100.0
    assert rows == pytest.approx(2 / 3 * spot * (1 + slope), rel=0.12)
    depth = frame.depth[flying]
    assert depth.min() > NEAR
    assert depth.max() < FAR
    # Of one near and four far rays, weighted by 1 / z^2, and so on.
    mixtures = [(n / NEAR + (5 - n) / FAR) / (n / NEAR**2 + (5 - n) / FAR**2) for n in range(1, 5)]
    np.testing.assert_allclose(np.abs(depth[:, None] - mixtures).min(axis=1), 0, atol=1e-4)


def test_the_filter_takes_its_share_of_the_flying_pixels() -> None:
    frames = sensed(quiet("tof", rejected_share=0.75), BEFORE, wall(FAR), frames=6)
    edge, flying = share(Reason.EDGE, *frames), share(Reason.MIXED, *frames)
    assert edge / (edge + flying) == pytest.approx(0.75, abs=0.03)


@pytest.mark.parametrize("depth", [1.0, 2.0, 4.0])
def test_stereos_error_grows_with_the_square_of_the_distance(depth: float) -> None:
    sensor = quiet("stereo", disparity_sigma_px=0.08)
    noise = errors(sensor, wall(depth), frames=3)
    assert np.nanstd(noise) == pytest.approx(0.08 * depth**2 / (sensor.focal_px * sensor.baseline_m), rel=0.05)


def test_stereo_fattens_what_is_in_front() -> None:
    sensor = quiet("stereo", focal_px=CAMERA.fx, window_px=7, fattening_share=0.25, baseline_m=0.3)
    (frame,) = sensed(sensor, BEFORE, wall(FAR))
    fat = frame.reason == Reason.MIXED
    # Of seven columns two are 0.29: the second column beside the wall still sees so much; the shadow takes the left.
    assert fat.sum(axis=1).mean() == pytest.approx(2, abs=0.01)
    assert (frame.labels.objectid[fat] == 2).all()
    np.testing.assert_allclose(frame.depth[fat], NEAR, atol=1e-5)


@pytest.mark.parametrize("wanted", [0.02, 0.2])
def test_structured_light_has_its_share_of_holes(wanted: float) -> None:
    frames = sensed(quiet("structured_light", hole_share=wanted), wall(3.0), frames=6)
    assert share(Reason.NO_SIGNAL, *frames) == pytest.approx(wanted, rel=0.2)


def test_rays_of_its_own_without_meshes_are_refused() -> None:
    with pytest.raises(InputError, match=r"truth\.npz"):
        View(camera=CAMERA).reached_from(0.1, np.full((120, 160), 2, np.float32))


@pytest.mark.parametrize(
    ("sensor", "sentence"),
    [
        ({"preset": "kinect1", "baseline_m": 0}, "sensor.baseline_m: .* greater than 0"),
        ({"preset": "kinect1", "edge_share": 2}, "sensor.edge_share: .* less than or equal to 1"),
        ({"preset": "tof", "wobble": 1}, "unknown key 'sensor.wobble', did you mean 'wobble_m'"),
        ({"preset": "tof", "spot_px": 3}, "sensor.spot_px: .* less than or equal to 2"),
        ({"preset": "stereo", "nearest_m": 12}, "sensor: expected 'nearest_m' below 'farthest_m'"),
        ({"preset": "structured_light", "hole_share": 1}, "sensor.hole_share: .* less than 1"),
    ],
)
def test_an_impossible_parameter_is_refused_by_name(sensor: dict[str, object], sentence: str) -> None:
    document = simulate("wall", frames=1, size="32x24").metadata.scene
    with pytest.raises(InputError, match=sentence):
        validated(Scene, document | {"sensor": sensor}, source="test")
