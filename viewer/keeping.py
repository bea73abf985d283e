"""The file in which a recording's corrections by hand are kept."""

from pathlib import Path

from recording.corrections import Corrections, load_corrections, save_corrections
from recording.errors import InputError
from recording.recording import Recording


class CorrectionsFile:
    """What stands in the file is replaced only where it is what was read from it, or written to it, before."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.known: Corrections | None = None
        """What was read or written last."""

    def read(self, recording: Recording) -> None:
        """Know what stands there, if there is such a file yet; InputError where it is another recording's."""
        if self.path.exists():
            found = load_corrections(self.path)
            found.check_belongs(recording.digest())
            self.known = found

    def save(self, corrections: Corrections) -> None:
        """Write them; InputError where somebody else's are there."""
        found = load_corrections(self.path) if self.path.exists() else None
        if found is not None and found not in (self.known, corrections):
            whose = "another recording" if found.recording_digest != corrections.recording_digest else "somebody else"
            raise InputError(
                f"{self.path}: expected the corrections that were read from here or none, got those of {whose}: "
                "move them away, or open the viewer with --corrections and another file"
            )
        save_corrections(corrections, self.path, overwrite=True)
        self.known = corrections
