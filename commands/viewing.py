"""Looking at recordings and motions: view."""

import webbrowser
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from cyclopts.validators import Number

from commands.common import CACHING, COMMON, Caching, Common
from evaluation.scores import check_belongs
from recording.errors import InputError
from recording.parquet import load_motions
from recording.store import load_recording


def view_command(
    recording: Path,
    motions: Path | None = None,
    *,
    corrections: Path | None = None,
    host: str = "127.0.0.1",
    port: Annotated[int, Parameter(validator=Number(gte=0, lte=65535))] = 8080,
    open_: Annotated[bool, Parameter(name="--open", negative="")] = False,
    caching: Caching = CACHING,
    common: Common = COMMON,
) -> None:
    """Look at a recording and its motions in a browser, solve it again under other settings, and correct it by hand.

    Example: `unocclude view recordings/wall`

    Ctrl-C ends it. Only this machine can look, unless `--host` says otherwise.

    Args:
        recording: The recording's folder.
        motions: The Parquet file; `motions.parquet` in the recording's folder by default, if there is one.
        corrections: TOML file of corrections by hand, which are read if there are any, and saved on demand;
            `corrections.toml` in the recording's folder by default.
        host: Address to serve at; `0.0.0.0` is for everybody who can reach this machine.
        port: Port to serve at; 0 takes any that is free.
        open_: Open a browser too.
    """
    if find_spec("viser") is None:
        raise InputError("view: expected the package viser, which is not installed: run pip install 'unocclude[view]'")
    from viewer.keeping import CorrectionsFile  # noqa: PLC0415 - as the viewer itself.
    from viewer.viewer import Viewer  # noqa: PLC0415 - viser is optional, and slow to import.

    truth = load_recording(recording)
    beside = recording / "motions.parquet"
    place = motions or (beside if beside.is_file() else None)
    answer = load_motions(place) if place is not None else None
    if answer is not None and (warning := check_belongs(truth, answer)):
        common.say(f"warning: {warning}")
    file = CorrectionsFile(corrections or recording / "corrections.toml")
    try:
        file.read(truth)
    except InputError as error:
        if corrections is not None:
            raise
        common.say(f"warning: {file.path}: {error}")
    with common.progress():
        viewer = Viewer(truth, answer, host=host, port=port, cache=caching.chosen(), file=file)
    if answer is None:
        common.say(f"{recording} has no motions yet: the panel Settings solves it")
    common.say(f"look at {viewer.address} (Ctrl-C ends it)")
    if open_:
        webbrowser.open(viewer.address)
    viewer.run()
