"""A data set of random scenes: a family's recordings under seeds in a row, and the manifest that lists them."""

import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from uuid import uuid4

from recording.cluster import Client, Task, cluster, finished, require_code
from recording.code import code_digest
from recording.errors import InputError
from recording.manifest import MANIFEST, Entry, FamilyRecord, Manifest, ManifestFormat, load_manifest
from recording.progress import tracked
from recording.version import VERSION
from simulator.backend import Backend, BackendWish, find_backend
from simulator.order import Listed, Order, Refused, recorded
from simulator.simulate import digest_of

_CODE = ("simulator.order",)
_AHEAD = 10_000
"""Recordings that the scheduler knows of at a time: it needs a few kilobytes for each."""


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


def generate(
    order: Order,
    *,
    seeds: Sequence[int],
    workers: int = 1,
    backend: BackendWish = "auto",
    client: Client | None = None,
) -> Generated:
    """Make the recordings of the seeds, each whole or not at all, then the manifest.

    A recording that is there already is kept; one of another scene in its place is an error. A seed that the family
    has no scene for, or whose making brings its worker down, is left out, the others are made; a sensor, size or crowd
    that none can have is an error before any is drawn. Several workers are processes (`recording.cluster`); with a
    client its workers are taken, which must see the folder. Their number changes no byte.
    """
    if not seeds or min(seeds) < 0:
        raise InputError(f"expected at least one seed, and none below 0, got {list(seeds)[:3]}")
    seed, times = Counter(seeds).most_common(1)[0]
    if times > 1:
        raise InputError(f"expected every seed once, got seed {seed} {times} times: leave out what is repeated")
    order.check()
    earlier, begun = _earlier(order), time.monotonic()
    try:
        with _done(order, seeds, workers, backend, client) as results:
            done = list(tracked(results, f"generating {order.family.name}", total=len(seeds)))
        listed = sorted((one for one in done if isinstance(one, Listed)), key=lambda one: one.entry.seed)
        _check_unchanged(order, earlier, listed)
        if listed:
            order.shelf.write(MANIFEST, _manifest(order, earlier, [one.entry for one in listed]).text)
    finally:
        order.shelf.tidy()
    return Generated(
        recordings=tuple(one.entry for one in listed),
        kept=sum(not one.made for one in listed),
        frames=sum(one.entry.frames for one in listed if one.made),
        seconds=time.monotonic() - begun,
        refused=tuple(sorted((one for one in done if isinstance(one, Refused)), key=lambda one: one.seed)),
    )


@contextmanager
def _done(
    order: Order, seeds: Sequence[int], workers: int, backend: BackendWish, client: Client | None
) -> Iterator[Iterator[Listed | Refused]]:
    """What becomes of the seeds, in any order: by one worker in this process, by several elsewhere."""
    if client is not None:
        yield _by_cluster(order, seeds, backend, client)
    elif min(workers, len(seeds)) == 1:
        here = find_backend(backend)
        yield (recorded(order, seed, here) for seed in seeds)
    else:
        with cluster(workers=min(workers, len(seeds))) as own:
            yield _by_cluster(order, seeds, find_backend(backend), own)


def _by_cluster(
    order: Order, seeds: Sequence[int], backend: Backend | BackendWish, client: Client
) -> Iterator[Listed | Refused]:
    """The same by the client's workers; each finds a backend of its own where there is but a wish."""
    code = code_digest(*_CODE)
    by_key = {f"recording-{uuid4().hex}-{seed}": seed for seed in seeds}  # No other call's.
    tasks = {key: Task(key, _recorded, code, order, seed, backend) for key, seed in by_key.items()}
    for one in finished(client, tasks, list(tasks), at_once=_AHEAD):
        if one.failure is None:
            yield one.value
        elif one.failure.startswith(f"{InputError.__name__}: "):
            raise InputError(one.failure.removeprefix(f"{InputError.__name__}: "))
        else:
            yield Refused(seed=by_key[one.key], sentence=one.failure)


def _recorded(code: str, order: Order, seed: int, backend: Backend | BackendWish) -> Listed | Refused:
    require_code(code, *_CODE)
    return recorded(order, seed, find_backend(backend) if isinstance(backend, str) else backend)


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
    if not order.shelf.holds(MANIFEST):
        return ()
    with order.shelf.fetched(MANIFEST) as path:
        listed, wanted = load_manifest(path.parent), _manifest(order, (), ())
    if any(getattr(listed, key) != getattr(wanted, key) for key in ("family", "sensor", "size")):
        if order.overwrite:
            return ()
        raise InputError(
            f"{order.folder}/{MANIFEST}: expected a data set of the same family, sensor and size, got one of "
            f"{listed.family.name!r} made otherwise: choose another folder, or pass --overwrite to replace it"
        )
    return tuple(entry for entry in listed.recordings if order.shelf.holds(entry.name))


def _check_unchanged(order: Order, earlier: Sequence[Entry], listed: Sequence[Listed]) -> None:
    """Raise where a recording that was kept is not what the manifest has listed."""
    digests = {entry.name: entry.digest for entry in earlier}
    for step in listed:
        name = step.entry.name
        if not step.made and digests.get(name, step.entry.digest) != step.entry.digest:
            raise InputError(
                f"{order.folder}/{name}: expected depths with the digest in {MANIFEST}, got others: "
                "the frames were changed; pass --overwrite to make them again"
            )
