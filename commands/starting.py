"""First steps: demo, doctor."""

import json
from pathlib import Path

from commands.common import COMMON, WRITING, Common, Output, Writing
from commands.solving import solve_command
from evaluation.doctor import diagnosis
from evaluation.picture import draw_overview
from evaluation.scores import evaluate
from evaluation.summary import summary
from recording.atomic import whole_file
from recording.parquet import load_motions
from recording.store import load_recording
from simulator.simulate import prepared, write_simulation


def demo_command(*, output: Output = Path("demo"), seed: int = 0, common: Writing = WRITING) -> None:
    """Run the main job on the scene `wall`: simulate, solve, evaluate, draw.

    Example: `unocclude demo -o demo`

    Args:
        output: Folder for the recording, the motions, the scores and the picture.
        seed: 0 is the scene itself; any other number is the same scene on another day.
    """
    simulation = prepared("wall", seed=seed)
    place = output / simulation.scene.name
    with common.progress():
        write_simulation(simulation, place, overwrite=common.overwrite)
    common.say(f"simulated {place}: {simulation.scene.frames} frames, {simulation.clearance.sentence}")
    solve_command(place, common=common)
    recording, motions = load_recording(place), load_motions(place / "motions.parquet")
    found = evaluate(recording, motions)
    with whole_file(output / "scores.json", overwrite=common.overwrite) as partial:
        partial.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    draw_overview(recording, motions, output / "overview.png", overwrite=common.overwrite)
    print(summary(found))
    print(f"pictures: {output / 'overview.png'}")


def doctor_command(*, common: Common = COMMON) -> None:
    """Tell what this machine has: versions, rendering backend, cores, and what is missing.

    Example: `unocclude doctor`
    """
    print(diagnosis())
