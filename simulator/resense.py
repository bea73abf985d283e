"""A recording as another sensor would have seen it: the same truth, other depths.

Pictures are not cast again. A sensor that casts rays of its own does so among the truth meshes; so what comes
out is, to the byte, what simulating the scene with that sensor gives.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from recording.achieved import achieved_occlusion
from recording.causes import Tally, tally_of
from recording.errors import InputError
from recording.frame import Frame
from recording.metadata import Metadata
from recording.progress import tracked
from recording.recording import Recording
from recording.store import new_recording, write_metadata, write_picture
from recording.xray import XRay
from simulator.sensed import exact_reasons
from simulator.sensor import Sensor, on_another_day, sensed_frame, sensor_named
from simulator.simulate import digest_of
from simulator.view import View


def resense(recording: Recording, sensor: str | Sensor, *, seed: int | None = None) -> Recording:
    """The recording as the sensor, or the preset of that name, sees it.

    `seed` is that of its noise; where there is none, it is the recording's own, as when the scene is simulated.
    """
    chosen, pictures = _chosen(recording, sensor, seed), []
    tallies = []
    for frame, xray in _pictures(recording, chosen):
        pictures.append(frame)
        tallies += _tally(frame, xray, recording.metadata)
    return replace(recording, metadata=_metadata(recording.metadata, chosen, tallies), frames=tuple(pictures))


def write_resensed(
    recording: Recording, sensor: str | Sensor, folder: Path, *, seed: int | None = None, overwrite: bool = False
) -> None:
    """The same, straight to a folder: one picture is in memory at a time."""
    chosen = _chosen(recording, sensor, seed)
    with new_recording(folder, truth=recording.truth, overwrite=overwrite) as partial:
        tallies: list[Tally] = []
        for number, (frame, xray) in enumerate(_pictures(recording, chosen)):
            write_picture(partial, number, frame, xray, metadata=recording.metadata)
            tallies += _tally(frame, xray, recording.metadata)
        write_metadata(partial, _metadata(recording.metadata, chosen, tallies))


def _chosen(recording: Recording, sensor: str | Sensor, seed: int | None) -> Sensor:
    model = sensor_named(sensor) if isinstance(sensor, str) else sensor
    return on_another_day(model, (recording.metadata.seed or 0) if seed is None else seed)


def _pictures(recording: Recording, sensor: Sensor) -> Iterator[tuple[Frame, XRay | None]]:
    """Each frame with the X-ray that it has already."""
    numbers = range(recording.metadata.frames)
    for number in tracked(numbers, "sensing", total=recording.metadata.frames):
        exact = _exact(recording.frames[number], number)
        view = View(camera=recording.camera, meshes=recording.truth, frame=number)
        xray = None if recording.xray is None else recording.xray[number]
        yield sensed_frame(exact, view, sensor, number=number), xray


def _exact(frame: Frame, number: int) -> Frame:
    """The frame before any sensor."""
    if frame.clean_depth is None or frame.labels is None:
        raise InputError(
            f"frame {number}: expected exact depth (Z.clean) and labels, as simulated recordings have them, "
            "but what is behind a real sensor's noise nobody knows: give a simulated recording"
        )
    exact = replace(frame, depth=frame.clean_depth, reason=None)
    return replace(exact, reason=exact_reasons(exact))


def _tally(frame: Frame, xray: XRay | None, metadata: Metadata) -> list[Tally]:
    return [] if xray is None else [tally_of(frame, xray, metadata)]


def _metadata(metadata: Metadata, sensor: Sensor, tallies: list[Tally]) -> Metadata:
    """What is known about the new recording."""
    document = sensor.model_dump(mode="json")
    changes: dict[str, object] = {"sensor": document}
    if metadata.scene is not None:
        scene = metadata.scene | {"sensor": document}
        changes |= {"scene": scene, "scene_digest": digest_of(scene)}
    if metadata.occlusion is not None and tallies:
        nearness = metadata.occlusion.achieved.clearance_m
        achieved = achieved_occlusion(tallies, metadata, clearance_m=nearness)
        changes["occlusion"] = metadata.occlusion.model_copy(update={"achieved": achieved})
    return metadata.model_copy(update=changes)
