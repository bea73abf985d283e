"""Unocclude: simulate crowds before a depth camera, find what moves together, complete what was hidden.

The command line (`unocclude --help`) and the public names. In Python the verbs are the same, on values
instead of files:

    import unocclude

    recording = unocclude.simulate("wall", seed=1)
    motions = unocclude.solve(recording)
    print(unocclude.evaluate(recording, motions)["completion"]["centre_mean_m"])
"""

import sys

try:
    from cyclopts import App

    from algorithm.estimate import estimated
    from algorithm.settings import Settings, preset_settings
    from algorithm.staged import solve
    from commands import drawing, exporting, importing, judging, making, reporting, solving, starting, sweeping, viewing
    from commands.common import run
    from evaluation.scores import evaluate
    from exporting.export import export
    from recording.cache import Cache
    from recording.camera import Camera
    from recording.causes import causes_of
    from recording.corrections import Anchor, Correction, Corrections, load_corrections, save_corrections
    from recording.correspondence import flow_between, places_of, track
    from recording.errors import InputError
    from recording.manifest import load_manifest, recordings_of
    from recording.motions import Motions
    from recording.parquet import load_motions, save_motions
    from recording.recording import Recording
    from recording.sensed import depth_recording
    from recording.store import load_recording, save_recording
    from recording.verify import verify
    from recording.version import VERSION
    from recording.visibility import visibility_of
    from simulator.family import load_family
    from simulator.generate import generate
    from simulator.order import Order
    from simulator.resense import resense
    from simulator.simulate import simulate
except KeyboardInterrupt:  # Importing takes a second or more; Ctrl-C ends it as it ends a command.
    print("unocclude: interrupted; nothing half-written is left", file=sys.stderr)
    sys.exit(130)

__all__ = [
    "Anchor",
    "Cache",
    "Camera",
    "Correction",
    "Corrections",
    "InputError",
    "Motions",
    "Order",
    "Recording",
    "Settings",
    "causes_of",
    "depth_recording",
    "estimated",
    "evaluate",
    "export",
    "flow_between",
    "generate",
    "load_corrections",
    "load_family",
    "load_manifest",
    "load_motions",
    "load_recording",
    "places_of",
    "preset_settings",
    "recordings_of",
    "resense",
    "save_corrections",
    "save_motions",
    "save_recording",
    "simulate",
    "solve",
    "track",
    "verify",
    "visibility_of",
]

app = App(
    name="unocclude",
    help="Simulate crowds before a depth camera, find what moves together, complete what was hidden.",
    version=VERSION,
    help_format="markdown",
    suppress_keyboard_interrupt=False,  # `run` says that nothing half-written is left.
)
app.command(starting.demo_command, name="demo")
app.command(making.simulate_command, name="simulate", help_epilogue=making.SCENES_HELP)
app.command(making.generate_command, name="generate", help_epilogue=making.FAMILIES_HELP)
app.command(making.resense_command, name="resense")
app.command(importing.import_command, name="import", help_epilogue=importing.EXAMPLES_HELP)
app.command(solving.solve_command, name="solve", help_epilogue=solving.SETTINGS_HELP)
app.command(judging.evaluate_command, name="evaluate")
app.command(judging.verify_command, name="verify")
app.command(drawing.draw_command, name="draw")
app.command(drawing.contact_sheet_command, name="contact-sheet")
app.command(judging.table1_command, name="table1")
app.command(judging.compare_command, name="compare", help_epilogue=judging.METHODS_HELP)
app.command(sweeping.sweep_command, name="sweep")
app.command(sweeping.tune_command, name="tune")
app.command(drawing.figure_command, name="figure", help_epilogue=drawing.FIGURES_HELP)
app.command(viewing.view_command, name="view")
app.command(reporting.report_command, name="report")
app.command(exporting.export_command, name="export")
app.command(starting.doctor_command, name="doctor")


def main(arguments: list[str] | None = None) -> None:
    """Run the command line: exit status 0 done, 1 a check failed, 2 the input or the arguments are wrong."""
    run(app, arguments, name="unocclude")


if __name__ == "__main__":
    main()
