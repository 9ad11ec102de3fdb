"""Files that vanish, shrink, or become others while a verb reads them: an error, never a signal."""
import os
import shutil
import struct

from running import Running
from stage import contents, is_temporary, not_finite

NAME = "files"
_ANSWERS = (0, 2, 3, 4, 64, 75)  # docs/verbs.md: what a file can be the cause of

# A verb, and the files that it reads.
_READERS = [
    ("compare long.pc2 long2.pc2", ("long.pc2", "long2.pc2")),
    ("check long", ("long/take.pc2", "long/dataset.json", "limb.glb")),
    ("check draft", ("draft/a.nodes", "draft/a.status.json")),
    ("train draft --out new.safetensors", ("draft/a.nodes", "bend.glb", "muscles.json")),
    ("train long --out new.safetensors", ("long/take.pc2",)),
    ("train draft --out limb.safetensors --update", ("draft/a.nodes", "limb.training/layout.safetensors")),
    ("eval limb.safetensors --clip bend.glb --device cpu --out new.pc2", ("limb.safetensors", "bend.glb")),
    ("eval limb.safetensors --clip bend.glb --device cpu --jiggle --out new.pc2", ("limb.dynamics.safetensors",)),
    ("dataset add elsewhere --clip bend.glb --fps 960 --frames 1-1800 --shapes long.pc2 --name new", ("long.pc2",)),
    ("test limb.safetensors long", ("long/take.pc2",)),
    ("attach prop1.glb limb.safetensors", ("prop1.glb", "limb.attached.safetensors")),
    ("view limb.safetensors bend.glb --headless --size 160 120 --truth long.pc2 --fps 960 -o view.png",
     ("long.pc2", "limb.safetensors")),
]


def attack(stage, findings, random, clock, _tools):
    readers = []
    while not clock.over():
        if not readers:
            readers = random.sample(_READERS, len(_READERS))
        arguments, names = readers.pop()
        damage_while_read(stage, findings, random, arguments, random.choice(names))


def damage_while_read(stage, findings, random, arguments, name):
    work = stage.copy()
    write_long(stage, work)
    before = contents(work).keys()
    damage = random.choice([vanish, shrink, shrink, become_folder, become_noise])
    share, after = random.random(), random.random() ** 2 * 0.5
    running = Running(stage.command(arguments), work)
    try:
        running.process.wait(after)
    except Exception:  # it still runs
        pass
    damage(work / name, share)
    outcome = running.wait()
    findings.attempt(NAME)
    what = f"{arguments}: {damage.__name__} {name} after {after:.3f} s"
    if not findings.ended(NAME, outcome, [work]) and outcome.code not in _ANSWERS:
        findings.add(NAME, "losses", f"{what}: exit code {outcome.code}", [work], outcome.text())
    stranded = [name for name in contents(work).keys() - before if is_temporary(name)]
    if stranded:
        findings.add(NAME, "stranded", f"{what}: {', '.join(stranded)}", [work], outcome.text())
    for cache in not_finite(work):
        if outcome.code == 0 and cache not in before:
            findings.add(NAME, "NaN", f"{what}: {cache}", [work], outcome.text())


def write_long(stage, work):
    """Caches that take a while to read: those of the shot, again and again."""
    shot, samples = stage.files["shot.pc2"], 1800
    points, = struct.unpack_from("<i", shot, 16)
    body = shot[32:32 + 12 * points]
    cache = shot[:28] + struct.pack("<i", samples) + body * samples
    (work / "long.pc2").write_bytes(cache)
    (work / "long2.pc2").write_bytes(cache)
    shutil.copytree(work / "elsewhere", work / "long")
    (work / "long" / "take.pc2").write_bytes(cache)
    (work / "long" / "dataset.json").write_text(
        '{"schema": "bodyopt-dataset-1", "character": "../limb.glb", "takes": [{"name": "take", "clip": "../bend.glb", '
        '"fps": 960.0, "first_frame": 1, "frames": "1-1800", "shapes": "take.pc2"}]}')


def vanish(path, _share):
    path.unlink(missing_ok=True)


def shrink(path, share):
    if path.exists():
        os.truncate(path, int(share * path.stat().st_size))


def become_folder(path, _share):
    path.unlink(missing_ok=True)
    path.mkdir()


def become_noise(path, share):
    if path.exists():
        with open(path, "r+b") as file:
            file.seek(int(share * path.stat().st_size))
            file.write(bytes(range(256)))
