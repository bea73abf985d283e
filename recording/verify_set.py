"""A whole data set held against itself, recording by recording, and against its manifest."""

from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from recording.errors import InputError
from recording.manifest import Entry, listed_recording, load_manifest
from recording.progress import tracked
from recording.verify import Check, Report, verify
from recording.workers import reported


@dataclass(frozen=True, kw_only=True)
class Finding:
    """What `verify` found in one recording of a data set."""

    name: str
    report: Report
    """Without any check where the recording cannot be read, or is not the one that the manifest lists."""
    refusal: str | None = None
    """Why not."""

    @property
    def passes(self) -> bool:
        """Whether it is what the manifest lists, and every check passes."""
        return self.refusal is None and self.report.passes

    @property
    def text(self) -> str:
        """One line: what fails, or that nothing does."""
        if self.refusal is not None:
            return f"FAIL {self.name}: {self.refusal}"
        failing = [f"{check.name} {check.sentence}" for check in self.report.checks if not check.passes]
        return f"FAIL {self.name}: {'; '.join(failing)}" if failing else f"ok   {self.name}"


@dataclass(frozen=True, kw_only=True)
class SetReport:
    """What `verify_set` found."""

    findings: tuple[Finding, ...]
    """One a recording, in the manifest's order."""

    @property
    def passes(self) -> bool:
        """Whether every recording passes."""
        return all(finding.passes for finding in self.findings)

    @property
    def worst(self) -> tuple[tuple[Check, str], ...]:
        """Of each check that with the largest error, and the name of its recording."""
        found: dict[str, tuple[Check, str]] = {}
        for finding in self.findings:
            for check in finding.report.checks:
                if check.name not in found or check.largest > found[check.name][0].largest:
                    found[check.name] = check, finding.name
        return tuple(found.values())

    @property
    def text(self) -> str:
        """A line for each recording, and one for the worst of each check."""
        worst = [check.text + (f" ({name})" if check.largest else "") for check, name in self.worst]
        failing = sum(not finding.passes for finding in self.findings)
        summary = f"{len(self.findings)} recordings, {failing or 'none'} of which fail; the largest error of each kind:"
        return "\n".join([*(finding.text for finding in self.findings), "", summary, *worst])


@dataclass(frozen=True, kw_only=True)
class _Part:
    """The recordings that one process verifies."""

    folder: Path
    entries: Sequence[Entry]

    def reports(self) -> Iterator[Finding]:
        """What was found, recording by recording."""
        for entry in self.entries:
            try:
                report = verify(listed_recording(self.folder, entry))
            except InputError as error:
                yield Finding(name=entry.name, report=Report(checks=()), refusal=str(error))
            else:
                yield Finding(name=entry.name, report=report)


def verify_set(folder: Path, *, workers: int = 1) -> SetReport:
    """What `verify` finds in each recording of the data set in the folder, whose depths must be those of the manifest.

    A recording that cannot be read does not keep the others from being verified. Workers are processes.
    """
    entries = load_manifest(folder).recordings
    count = max(1, min(workers, len(entries)))
    parts = [_Part(folder=folder, entries=entries[first::count]) for first in range(count)]
    with closing(reported(parts, at_once=count)) as findings:
        found = {finding.name: finding for finding in tracked(findings, "verifying", total=len(entries))}
    return SetReport(findings=tuple(found[entry.name] for entry in entries))
