"""A data set of random scenes: a family's recordings under seeds in a row, and the manifest that lists them."""

import time
from collections import Counter
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from math import ceil

from recording.errors import InputError
from recording.manifest import MANIFEST, Entry, FamilyRecord, Manifest, ManifestFormat, load_manifest, save_manifest
from recording.progress import tracked
from recording.version import VERSION
from recording.workers import reported
from simulator.backend import Backend, BackendWish, find_backend
from simulator.order import Batch, Listed, Order, Refused
from simulator.simulate import digest_of

_AT_A_TIME = 25
"""Recordings that one process makes at the most, so that none waits long for the others in the end."""


@dataclass(frozen=True, kw_only=True)
class Generated:
    """What became of a call."""

    recordings: tuple[Entry, ...]
    """Of the seeds that were asked for, by seed."""
    kept: int
    """How many of them were there already."""
    frames: int
    """How many frames were made."""
    seconds: float
    refused: tuple[Refused, ...]
    """The seeds that have no recording, for the family has no scene for them."""

    @property
    def sentence(self) -> str:
        """What was done, in one line."""
        there = f" ({self.kept} of them were there already)" if self.kept else ""
        return (
            f"{len(self.recordings)} recordings{there}, {self.frames} frames made in {self.seconds:.1f} s: "
            f"{self.frames / self.seconds:.1f} a second"
        )

    @property
    def refusal(self) -> str | None:
        """Which seeds have no recording, and why the first of them has none; None where all have."""
        if not self.refused:
            return None
        count = len(self.refused) + len(self.recordings)
        seeds = ", ".join(str(each.seed) for each in self.refused)
        return f"{len(self.refused)} of {count} seeds have no scene ({seeds}): {self.refused[0].sentence}"


def generate(order: Order, *, seeds: Sequence[int], workers: int = 1, backend: BackendWish = "auto") -> Generated:
    """Make the recordings of the seeds, each whole or not at all, then the manifest.

    A recording that is there already is kept; one of another scene in its place is an error. A seed that the family
    has no scene for is left out, the others are made; a sensor, size or crowd that none can have is an error before
    any is drawn. Workers are processes, each of which makes whole recordings;
    their number changes no byte.
    """
    if not seeds or min(seeds) < 0:
        raise InputError(f"expected at least one seed, and none below 0, got {list(seeds)[:3]}")
    seed, times = Counter(seeds).most_common(1)[0]
    if times > 1:
        raise InputError(f"expected every seed once, got seed {seed} {times} times: leave out what is repeated")
    order.check()
    earlier, begun = _earlier(order), time.monotonic()
    with closing(reported(_batches(order, seeds, workers, find_backend(backend)), at_once=workers)) as steps:
        finished = (step for step in steps if isinstance(step, Listed | Refused))
        done = list(tracked(finished, f"generating {order.family.name}", total=len(seeds)))
    listed = sorted((step for step in done if isinstance(step, Listed)), key=lambda step: step.entry.seed)
    _check_unchanged(order, earlier, listed)
    if listed:
        save_manifest(_manifest(order, earlier, [step.entry for step in listed]), order.folder)
    return Generated(
        recordings=tuple(step.entry for step in listed),
        kept=sum(not step.made for step in listed),
        frames=sum(step.entry.frames for step in listed if step.made),
        seconds=time.monotonic() - begun,
        refused=tuple(sorted((step for step in done if isinstance(step, Refused)), key=lambda step: step.seed)),
    )


def _batches(order: Order, seeds: Sequence[int], workers: int, backend: Backend) -> list[Batch]:
    """The seeds in as many batches as make work for all workers, each as long as the others."""
    count = min(max(workers, 1) * ceil(len(seeds) / (max(workers, 1) * _AT_A_TIME)), len(seeds))
    return [Batch(order=order, seeds=seeds[first::count], backend=backend) for first in range(count)]


def _manifest(order: Order, earlier: Sequence[Entry], entries: Sequence[Entry]) -> Manifest:
    """The manifest of what there is now: new entries in the place of old ones."""
    by_name = {entry.name: entry for entry in (*earlier, *entries)}
    document = order.family.model_dump(mode="json")
    return Manifest(
        format=ManifestFormat(),
        family=FamilyRecord(name=order.family.name, digest=digest_of(document), document=document),
        sensor=order.sensor,
        size=order.size,
        made_by=f"unocclude {VERSION}",
        recordings=tuple(sorted(by_name.values(), key=lambda entry: entry.seed)),
    )


def _earlier(order: Order) -> tuple[Entry, ...]:
    """The entries of earlier calls whose recordings are there; an InputError where they are of another order."""
    if not (order.folder / MANIFEST).is_file():
        return ()
    listed, wanted = load_manifest(order.folder), _manifest(order, (), ())
    if any(getattr(listed, key) != getattr(wanted, key) for key in ("family", "sensor", "size")):
        if order.overwrite:
            return ()
        raise InputError(
            f"{order.folder / MANIFEST}: expected a data set of the same family, sensor and size, got one of "
            f"{listed.family.name!r} made otherwise: choose another folder, or pass --overwrite to replace it"
        )
    return tuple(entry for entry in listed.recordings if (order.folder / entry.name / "recording.json").is_file())


def _check_unchanged(order: Order, earlier: Sequence[Entry], listed: Sequence[Listed]) -> None:
    """Raise where a recording that was kept is not what the manifest has listed."""
    digests = {entry.name: entry.digest for entry in earlier}
    for step in listed:
        name = step.entry.name
        if not step.made and digests.get(name, step.entry.digest) != step.entry.digest:
            raise InputError(
                f"{order.folder / name}: expected depths with the digest in {MANIFEST}, got others: "
                "the frames were changed; pass --overwrite to make them again"
            )
