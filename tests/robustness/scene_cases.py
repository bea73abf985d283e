"""Wrong scenes, families, sweeps and data sets."""

import shutil
from pathlib import Path

from case import Case, Damage, cut, keyed, linked, removed, replaced, written

SMALL = "simulate {place}/small.toml -o {place}/out --backend scalar"
WALKED = "simulate {place}/walked.toml -o {place}/out --backend scalar"
CAPTURED = "simulate {place}/captured.toml -o {place}/out --backend scalar"
GENERATE = "generate {place}/tiny.toml --count 1 -o {place}/out --backend scalar"
SWEEP = "sweep {place}/sweep.toml -o {place}/out --workers 1"
VERIFY_SET = "verify {place}/set --workers 1"


def outside(place: Path) -> None:
    """A trajectory file that is a link out of the scene's folder."""
    (place.parent / "outside.txt").write_text("3 0 0 0\n3 9 1 0\n", encoding="utf-8")
    linked("walks.txt", "../outside.txt")(place)


def small(old: str, new: str) -> Damage:
    return replaced("small.toml", old, new)


def walked(new: str) -> Damage:
    return replaced("walked.toml", "'walks.txt'", new)


def twin(place: Path) -> str:
    """The scene's person once more."""
    return "[[people]]" + (place / "small.toml").read_text(encoding="utf-8").partition("[[people]]")[2]


SCENES = (
    Case(input="an unknown name", command="simulate wal -o {place}/out", says="did you mean 'wall'?"),
    Case(input="no file", command="simulate {place}/none.toml -o {place}/out", says="expected a readable TOML file"),
    Case(input="zero bytes", command=SMALL, damage=written("small.toml", ""), says="key 'name' is missing"),
    Case(input="truncated", command=SMALL, damage=cut("small.toml", 0.5), says="small.toml: "),
    Case(input="a key twice", command=SMALL, damage=small("fps = 15", "fps = 15\nfps = 15"), says="expected TOML"),
    Case(
        input="an unknown key", command=SMALL, damage=small("fps = 15", "fps = 15\nfsp = 15"), says="unknown key 'fsp'"
    ),
    Case(
        input="nested 100,000 deep",
        command=SMALL,
        damage=small("fps = 15", "fps = " + "[" * 100_000),
        says="maximum recursion depth exceeded",
    ),
    Case(input="NaN", command=SMALL, damage=small("fps = 15", "fps = nan"), says="fps: input should be"),
    Case(input="an infinite speed", command=SMALL, damage=small("speed = 1.2", "speed = inf"), says="speed"),
    Case(input="a negative speed", command=SMALL, damage=small("speed = 1.2", "speed = -1"), says="speed"),
    Case(input="a way-point 10^300 m away", command=SMALL, damage=small("[1, 0]]", "[1e300, 0]]"), says="waypoints"),
    Case(input="a picture 10^9 wide", command=SMALL, damage=small("width = 24", "width = 1000000000"), says="width"),
    Case(input="a picture too large to hold", command=SMALL + " --size 1000000x2", says="width"),
    Case(input="10^12 frames", command=SMALL + " --frames 1000000000000", says="frames"),
    Case(
        input="a camera that looks at itself",
        command=SMALL,
        damage=small("look_at = [0, 0, 1]", "look_at = [0, -4, 1.2]"),
        says="expected 'look_at' to be another point",
    ),
    Case(input="nobody and nothing", command=SMALL, damage=small("[[people]]", "[[none]]"), says="none"),
    Case(
        input="two people in one place",
        command=SMALL,
        damage=lambda place: written("small.toml", (place / "small.toml").read_text() + twin(place))(place),
        says="between the centres of people",
    ),
    Case(input="a Unicode name", command=SMALL, damage=small('"small"', '"Straße"'), says="name: "),
    Case(input="a name that escapes", command=SMALL, damage=small('"small"', '"../small"'), says="name: "),
    Case(input="an unknown sensor", command=SMALL + " --sensor kinect", says="sensor"),
    Case(input="an unknown body", command=SMALL, damage=small('"man"', '"giant"'), says="people.0.body"),
    Case(input="a recording that exists", command=SMALL.replace("/out", ""), says="pass --overwrite to replace it"),
    Case(
        input="a file in the recording's place", command=SMALL.replace("/out", "/small.toml"), says="cannot be written"
    ),
    Case(
        input="a place that nobody can write to",
        command=SMALL.replace("{place}/out", "/proc/x"),
        says="cannot be written",
    ),
)
FILES = (
    Case(input="a path that escapes", command=WALKED, damage=walked("'../x.txt'"), says="scene's folder"),
    Case(input="an absolute path", command=WALKED, damage=walked("'/etc/passwd'"), says="scene's folder"),
    Case(input="a link that leads out", command=WALKED, damage=outside, says="scene's folder"),
    Case(input="a link to itself", command=WALKED, damage=linked("walks.txt", "walks.txt"), says="walks.txt"),
    Case(input="a name with NUL", command=WALKED, damage=walked('"a\\u0000b"'), says="expected the path of a file"),
    Case(input="a device", command=WALKED, damage=walked('"/dev/zero"'), says="scene's folder"),
    Case(
        input="trajectories: no file",
        command=WALKED,
        damage=removed("walks.txt"),
        says="walks.txt: expected a readable",
    ),
    Case(input="trajectories: zero bytes", command=WALKED, damage=written("walks.txt", ""), says="got none"),
    Case(input="trajectories: foreign", command=WALKED, damage=written("walks.txt", b"\xff\xd8\xff"), says="no UTF-8"),
    Case(input="trajectories: words", command=WALKED, damage=written("walks.txt", "1 2 3 4\na b c d"), says="line 2"),
    Case(input="trajectories: NaN", command=WALKED, damage=written("walks.txt", "3 1 nan 0"), says="finite numbers"),
    Case(
        input="trajectories: a frame twice",
        command=WALKED,
        damage=written("walks.txt", "3 1 0 0\n3 1 1 0\n"),
        says="expected every frame of id 3 once",
    ),
    Case(
        input="trajectories: 10^300 m",
        command=WALKED,
        damage=written("walks.txt", "".join(f"3 {frame} {frame}e300 0\n" for frame in range(9))),
        says="walks.txt",
    ),
    Case(
        input="trajectories: 10^15 frames apart",
        command=WALKED,
        damage=written("walks.txt", "3 0 0 0\n3 1000000000000000 1 0\n"),
        says="walks.txt",
    ),
    Case(
        input="trajectories: nobody of the id",
        command=WALKED,
        damage=written("walks.txt", "1 1 0 0\n"),
        says="expected two rows at least of id 3",
    ),
    Case(input="BVH: no file", command=CAPTURED, damage=removed("clip.bvh"), says="clip.bvh: expected a readable BVH"),
    Case(input="BVH: zero bytes", command=CAPTURED, damage=written("clip.bvh", ""), says="the file ends"),
    Case(input="BVH: truncated", command=CAPTURED, damage=cut("clip.bvh", 0.5), says="clip.bvh"),
    Case(input="BVH: foreign", command=CAPTURED, damage=written("clip.bvh", b"\x89PNG\xff"), says="no UTF-8"),
    Case(
        input="BVH: 10^300 frames",
        command=CAPTURED,
        damage=replaced("clip.bvh", "Frames: 2", "Frames: 1e300"),
        says="it is truncated",
    ),
    Case(
        input="BVH: no time",
        command=CAPTURED,
        damage=replaced("clip.bvh", "0.033", "0"),
        says="expected seconds from frame to frame, above 0",
    ),
    Case(input="BVH: NaN", command=CAPTURED, damage=replaced("clip.bvh", "0 90 1", "0 nan 1"), says="finite numbers"),
    Case(
        input="BVH: another file than the digest's",
        command=CAPTURED,
        damage=replaced("captured.toml", "'clip.bvh'", "'clip.bvh', sha256 = 'ab'"),
        says="expected the file with the SHA-256 ab",
    ),
)
SETS = (
    Case(input="an unknown family", command="generate crowdy --count 1 -o {place}/out", says="'crowded'?"),
    Case(
        input="a range upside down", command=GENERATE, damage=replaced("tiny.toml", "= 1\n", "= [2, 1]\n"), says="range"
    ),
    Case(
        input="a billion people",
        command=GENERATE,
        damage=replaced("tiny.toml", "= 1\n", "= 1000000000\n"),
        says="count",
    ),
    Case(input="no recordings", command=GENERATE.replace("--count 1", "--count 0"), says="--count"),
    Case(input="a negative seed", command=GENERATE + " --seed -1", says="--seed"),
    Case(input="a manifest of zero bytes", command=VERIFY_SET, damage=written("set/manifest.json", ""), says="JSON"),
    Case(
        input="a manifest of a later version",
        command=VERIFY_SET,
        damage=keyed("format.version", 2, "set/manifest.json"),
        says="format.version",
    ),
    Case(
        input="a manifest with a path that escapes",
        command=VERIFY_SET,
        damage=keyed("recordings.0.name", "../small", "set/manifest.json"),
        says="recordings.0.name",
    ),
    Case(
        input="a manifest with an absolute path",
        command=VERIFY_SET,
        damage=keyed("recordings.0.name", "/etc", "set/manifest.json"),
        says="recordings.0.name",
    ),
    Case(
        input="a recording that is missing",
        command=VERIFY_SET,
        damage=lambda place: (place / "set" / "tiny-000001").rename(place / "set" / "other"),
        status=1,
        says="tiny-000001: expected a recording",
        becomes="`verify` fails and names it; the others are verified",
    ),
    Case(
        input="frames that were changed",
        command=VERIFY_SET,
        damage=lambda place: shutil.copy(
            place / "set/tiny-000001/frames/000000.exr", place / "set/tiny-000001/frames/000001.exr"
        ),
        status=1,
        says="expected depths with the digest in manifest.json, got others",
        becomes="`verify` fails and names it; the others are verified",
    ),
    Case(input="a sweep without axes", command=SWEEP, damage=replaced("sweep.toml", "eps", "#"), says="axes"),
    Case(input="a sweep of no setting", command=SWEEP, damage=replaced("sweep.toml", "eps3", "eps9"), says="'eps9'"),
    Case(
        input="a sweep of 10^12 points",
        command=SWEEP,
        damage=replaced("sweep.toml", "[1.0, 2.0]", "{from = 1, to = 2, steps = 1000000000000}"),
        says="axes.eps3",
    ),
    Case(
        input="a sweep of 10^12 samples",
        command=SWEEP,
        damage=replaced("sweep.toml", "[axes]", "design = 'sobol'\nsamples = 1000000000000\n[axes]"),
        says="samples",
    ),
)
