"""The small character that the program is run on, every verb that writes, and what belongs to a folder afterwards."""
import fnmatch
import pathlib
import shlex
import shutil
import struct
from array import array
from dataclasses import dataclass

from running import run


@dataclass(frozen=True)
class Verb:
    name: str
    arguments: str
    # A second run after a kill, or a first one elsewhere, leaves the same bytes in all but STATED files.
    same_bytes: bool = True
    # A second run of what was done already is refused.
    once: bool = False
    # What has to be run in a fresh folder first: files that name their own folder.
    before: str = ""


_ADD = "dataset add elsewhere --clip bend.glb --frames 1-6"
_DYNAMICS = "dynamics draft --basis limb.safetensors --out limb.dynamics.safetensors"
_SIMULATE = "simulate limb.glb --clip bend.glb --muscles muscles.json --out draft"
VERBS = [
    Verb("simulate", f"{_SIMULATE} --frames 1-30 --tet-size 0.05 --name full"),
    Verb("simulate --draft", f"{_SIMULATE} --frames 1-48 --draft --name a --heldout 31-36"),
    Verb("dataset add", f"{_ADD} --shapes shapes1.pc2 --name more", once=True),
    Verb("dataset add --replace", f"{_ADD} --shapes shapes2.pc2 --name s0 --replace", same_bytes=False),
    Verb("curate add", "curate add elsewhere smooth --take s0", same_bytes=False),
    Verb("curate bake", "curate bake elsewhere --out baked", once=True),
    Verb("muscles import", "muscles import limb.glb --from model.osim mapping.json --out imported.json"),
    Verb("anatomy", "anatomy limb.glb --muscles muscles.json --picture anatomy.png --json anatomy.report.json"),
    Verb("rig", "rig limb.glb --out rig"),
    Verb("rom", "rom limb.glb --limits limits.json --frames 400 --out rom.glb"),
    Verb("train", "train draft --out limb.safetensors --surface-curves 3"),
    Verb("train --update", "train draft --out limb.safetensors --update", same_bytes=False),
    Verb("train --report", "train draft --out limb.safetensors --surface-curves 2 --report report"),
    Verb("train CHARACTER", "train limb.glb --clip bend.glb --minutes 0.1 --out own.safetensors", same_bytes=False),
    Verb("train --ddm-only", "train --ddm-only limb.glb --out ddm.safetensors"),
    Verb("regions", "regions draft --out regions.json --picture regions.png"),
    Verb("proxy", "proxy draft --out proxy.safetensors --error 3"),
    Verb("dynamics", f"{_DYNAMICS} --dynamics-resolution 900"),
    Verb("attach", "attach prop1.glb limb.safetensors"),
    Verb("transfer dataset", "transfer dataset draft limb.glb --out carried"),
    Verb("transfer basis", "transfer basis limb.safetensors limb.glb --out carried.safetensors"),
    Verb("transfer refine", "transfer refine draft --carried a", same_bytes=False,
         before=f"{_SIMULATE} --frames 1-36 --draft --name own"),
    Verb("modifiers", "modifiers limb.safetensors modifiers.json --out modified.safetensors"),
    Verb("eval", "eval limb.safetensors --clip bend.glb --fps 960 --device cpu --out shot.pc2"),
    Verb("eval --jiggle", "eval limb.safetensors --clip bend.glb --fps 24 --jiggle --device cpu --state-out end.state "
                          "--state-every 8 --out jiggled.pc2"),
    Verb("eval, USD", "eval limb.safetensors --clip bend.glb --fps 960 --device cpu --resume --out shot.usda"),
    Verb("eval --rigged", "eval limb.safetensors --clip bend.glb --character limb.glb --rigged --device cpu --out rig.glb"),
    Verb("join", "join part1.pc2 part2.pc2 --resume --out joined.pc2"),
    Verb("farm plan", "farm plan shots.json --out plan", same_bytes=False),
    Verb("farm run", "farm run plan", same_bytes=False, before="farm plan shots.json --task-minutes 0.02 --out plan"),
    Verb("farm report", "farm report plan --out show.html --json show.json", same_bytes=False,
         before="farm plan shots.json --out plan"),
    Verb("farm submit", "farm submit plan --openjd job.json", same_bytes=False,
         before="farm plan shots.json --out plan"),
    Verb("improve", "improve draft --basis limb.safetensors --clip bend.glb --frames 10", same_bytes=False),
    Verb("test", "test limb.safetensors draft --json test.json"),
    Verb("coverage", "coverage limb.safetensors --clip bend.glb --picture coverage.svg --json coverage.json"),
    Verb("export", "export draft/a.nodes --out exported.pc2"),
    Verb("picture", "picture draft --frame 3 --out picture.png"),
    Verb("view, a session", "view limb.safetensors bend.glb --headless --size 160 120 --cf 2 -o view.png "
                            "--do 'save session.json; save-state state.json; save-pose pose.json; export-clip kept.glb'"),
    Verb("view --headless", "view limb.safetensors bend.glb --headless --size 160 120 --ff 1 --lf 12 -o view.webp"),
]

# What is there before any attack.
_PREPARATION = [
    f"{_SIMULATE} --frames 1-36 --draft --name a --heldout 31-36",
    f"{_ADD} --character limb.glb --shapes shapes0.pc2 --name s0",
    "train draft --out limb.safetensors --surface-curves 2",
    f"{_DYNAMICS} --dynamics-resolution 500",
    "attach prop0.glb limb.safetensors",
    "rom limb.glb --limits limits.json --frames 20 --out rom.glb",
    "eval limb.safetensors --clip bend.glb --device cpu --out shot.pc2",
    "eval limb.safetensors --clip bend.glb --frames 1-20 --fps 960 --device cpu --out part1.pc2",
    "eval limb.safetensors --clip bend.glb --frames 21-900 --fps 960 --device cpu --out part2.pc2",
]
_SHOTS = """{"schema": "bodyopt-shots-1", "defaults": {"basis": "limb.safetensors", "clip": "bend.glb", "fps": 960,
 "device": "cpu", "out": "caches/{shot}.pc2"}, "elements": [
 {"shot": "short", "element": "limb", "frames": "1-60"},
 {"shot": "long", "element": "limb", "frame_ms": 10},
 {"shot": "usd", "element": "limb", "frames": "100-180", "out": "caches/{shot}.usda"}]}"""

# Hold seconds that were taken, and when files were written.
STATED = ("*.status.json", "*.done.json", "*.report.json", "report/*")
# Names under which files are written before they are renamed.
_TEMPORARY = ("*.tmp", "*.tmp.*")


class Stage:
    def __init__(self, program, writer, folder):
        self.program, self.folder = program, folder
        self.base = folder / "base"
        self._undisturbed = {}
        self.base.mkdir(parents=True)
        for command in [[writer, "."]] + [self.command(line) for line in _PREPARATION]:
            outcome = run(command, self.base)
            if outcome.code != 0:
                raise SystemExit(f"the attack cannot begin: {outcome.text()}")
        self.for_fuzzers = folder / "for_fuzzers"
        (self.base / "shots.json").write_text(_SHOTS)
        (self.base / "fuzz").rename(self.for_fuzzers)
        self.files = contents(self.base)

    def command(self, arguments):
        return [self.program] + shlex.split(arguments)

    def copy(self, name="work", verb=None):
        """A fresh folder with what was there before. Commands in it are the same words as elsewhere."""
        work = self.folder / name
        shutil.rmtree(work, ignore_errors=True)
        shutil.copytree(self.base, work)
        self.prepare(verb, work)
        return work

    def prepare(self, verb, work):
        """What a verb needs to be there, and what names the folder."""
        if verb is None or not verb.before:
            return
        outcome = run(self.command(verb.before), work)
        if outcome.code != 0:
            raise SystemExit(f"the attack cannot go on: {outcome.text()}")

    def undisturbed(self, verb):
        """What the verb leaves, by name, and how long it takes."""
        if verb.name not in self._undisturbed:
            work = self.copy("undisturbed", verb)
            outcome = run(self.command(verb.arguments), work)
            if outcome.code != 0:
                raise SystemExit(f"a verb fails undisturbed: {outcome.text()}")
            self._undisturbed[verb.name] = contents(work), outcome.seconds
        return self._undisturbed[verb.name]

    def unreadable(self, work):
        """Files that were there and are gone, or that changed and cannot be read: what is wrong with each."""
        now, wrong = contents(work), []
        for name, data in now.items():
            if data == self.files.get(name) or is_temporary(name):
                continue
            reader = None
            if name.endswith("dataset.json"):
                reader = "check"
            elif name.endswith((".safetensors", ".pc2", ".nodes", ".glb", ".state")) and ".training/" not in name:
                reader = "info"
            if reader:
                outcome = run([self.program, reader, name], work)
                if outcome.code != 0:
                    wrong.append(f"{name}: {outcome.text()}")
        for name in self.files.keys() - now.keys():
            # A training forgets the regions of the one before, and a correction the cache that it corrects.
            if ".training/" not in name and not fnmatch.fnmatch(name, "elsewhere/*.pc2"):
                wrong.append(f"{name} is gone")
        return wrong


def contents(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def is_temporary(name):
    return any(fnmatch.fnmatch(name.rsplit("/", 1)[-1], pattern) for pattern in _TEMPORARY)


def different(found, expected):
    """Names of files that should have the same bytes and do not."""
    names = [name for name in expected if not any(fnmatch.fnmatch(name, pattern) for pattern in STATED)]
    return [name for name in names if found.get(name) != expected[name]]


def not_finite(folder):
    """Names of point caches that hold a number that is none."""
    bad = []
    for path in filter(pathlib.Path.is_file, folder.rglob("*.pc2")):
        data = path.read_bytes()
        if len(data) < 32 or struct.unpack_from("<i", data, 12)[0] != 1:
            continue
        values = array("I", data[32:len(data) // 4 * 4])
        if any(word & 0x7F800000 == 0x7F800000 for word in values):
            bad.append(str(path.relative_to(folder)))
    return bad
