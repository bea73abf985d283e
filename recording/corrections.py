"""Corrections by hand: what a user says of a recording's segments and links, and `corrections.toml` that keeps it.

The contract between the viewer, which writes them, and the solver, which respects them (`algorithm.corrections`).
"""

import json
import os
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from recording.atomic import whole_file
from recording.checks import Frozen, toml_document, validated
from recording.errors import InputError

CorrectionKind = Literal["same", "different", "forbid", "force"]
Place = Annotated[float, Field(ge=-1e5, le=1e5)]
_HEADER = "# Corrections by hand; `unocclude solve RECORDING --corrections FILE` respects them (docs/corrections.md).\n"


class CorrectionsFormat(Frozen):
    """Which kind of document this is."""

    name: Literal["unocclude-corrections"] = "unocclude-corrections"
    version: Literal[1] = 1


class Anchor(Frozen):
    """A point in the picture that names the segment on which it lies, whatever number the settings give that."""

    frame: int = Field(ge=0, lt=2**31)
    column: Place
    """Pixels; the centre of the first pixel is 0.5."""
    row: Place
    segment: int | None = None
    """The number that the segment had when it was marked: for the reader alone."""


class Correction(Frozen):
    """What a user says of two segments."""

    kind: CorrectionKind
    """`same` = they are of one object; `different` = they are not; `force` = the first goes on as the second;
    `forbid` = it does not."""
    one: Anchor
    """On the first of them; for `force` and `forbid` the one that is seen first."""
    other: Anchor


class Corrections(Frozen):
    """All that was said of a recording, in order."""

    format: CorrectionsFormat = CorrectionsFormat()
    recording_digest: str = Field(pattern="^[0-9a-f]*$")
    """Of the recording that they belong to."""
    correction: tuple[Correction, ...] = ()

    def plus(self, *more: Correction) -> "Corrections":
        """These and more of them."""
        return self.model_copy(update={"correction": (*self.correction, *more)})

    def without(self, index: int) -> "Corrections":
        """These but for one."""
        return self.model_copy(update={"correction": self.correction[:index] + self.correction[index + 1 :]})

    def check_belongs(self, recording_digest: str) -> None:
        """Refuse corrections of another recording."""
        if self.recording_digest != recording_digest:
            raise InputError(
                f"corrections: expected those of this recording ({recording_digest[:12]}...), "
                f"got those of another one ({self.recording_digest[:12]}...): mark the segments anew"
            )


def load_corrections(path: str | os.PathLike[str]) -> Corrections:
    """The corrections in a TOML file."""
    place = Path(path)
    return validated(Corrections, toml_document(place), source=str(place))


def save_corrections(corrections: Corrections, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
    """Write the corrections as TOML, a table each."""
    with whole_file(Path(path), overwrite=overwrite) as partial:
        partial.write_text(_document(corrections), encoding="utf-8")


def _document(corrections: Corrections) -> str:
    """The TOML document: numbers and plain strings stand in it as in JSON."""
    lines = [
        _HEADER,
        f"format = {_inline(corrections.format)}",
        f"recording_digest = {json.dumps(corrections.recording_digest)}",
    ]
    for each in corrections.correction:
        lines += ["", "[[correction]]", f'kind = "{each.kind}"']
        lines += [f"one = {_inline(each.one)}", f"other = {_inline(each.other)}"]
    return "\n".join(lines) + "\n"


def _inline(value: Frozen) -> str:
    known = value.model_dump(mode="json", exclude_none=True)
    return "{ " + ", ".join(f"{key} = {json.dumps(entry)}" for key, entry in known.items()) + " }"
