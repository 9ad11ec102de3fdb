#!/usr/bin/env python3
"""Random edits of a dataset's stack of modifiers, some of them killed: curate_edits.py PROGRAM DATASET [--sequences N]
[--seed S]

After every kill the stack is the one before the edit or the one after it; after every sequence, undone to its end,
dataset.json is what it was, byte for byte, and so is every raw cache. Works on a copy of the dataset; exits with 1 at the
first that is not so, and says which."""
import argparse
import hashlib
import json
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

TYPES = ["smooth", "relax", "inflate", "drop", "freeze", "weight --set weight=2", "despike", "volume"]
REFUSED = 64


def edit(stack, dice):
    """The words of a random edit that the stack allows."""
    names = [modifier["name"] for modifier in stack]
    kind = dice.choice(["add", "add", "edit", "move", "enable", "disable", "remove", "undo", "redo"]) if names else "add"
    if kind == "add":
        frames = dice.choice(["", f"--frames {dice.randint(1, 3)}-{dice.randint(3, 6)}"])
        return ["add", "DATASET", *dice.choice(TYPES).split(), *frames.split(), "--strength", f"{dice.random():.3f}"]
    if kind in ("undo", "redo"):
        return [kind, "DATASET"]
    name = dice.choice(names)
    if kind == "edit":
        return [kind, "DATASET", name, "--strength", f"{dice.random():.3f}"]
    if kind == "move":
        return [kind, "DATASET", name, str(dice.randint(1, len(names)))]
    return [kind, "DATASET", name]


class Session:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.kills = self.edits = 0

    def start(self, words, folder):
        words = [str(folder) if word == "DATASET" else word for word in words]
        return subprocess.Popen([self.program, "curate", *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def run(self, words, folder=None):
        self.edits += 1
        return self.start(words, folder or self.folder).wait(timeout=600)

    def stack(self, folder=None):
        return json.loads(((folder or self.folder) / "dataset.json").read_text()).get("modifiers", [])

    def kill(self, words, seconds):
        """Kills the edit after so long, and checks what is left."""
        with tempfile.TemporaryDirectory() as clone:
            shutil.copytree(self.folder.parent, pathlib.Path(clone) / "all", symlinks=True)
            undisturbed = pathlib.Path(clone) / "all" / self.folder.name
            before = self.stack()
            process = self.start(words, self.folder)
            try:
                process.wait(timeout=seconds)
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGKILL)
                process.wait()
                self.kills += 1
            now = self.stack()
            if now == before:
                return
            self.run(words, undisturbed)
            if now != self.stack(undisturbed):
                sys.exit(f"killed after {seconds:.3f} s, '{' '.join(words)}' left neither the old stack nor the new one")


def hashes(folder):
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(folder.iterdir()) if path.suffix in (".pc2", ".nodes")}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("dataset", type=pathlib.Path)
    parser.add_argument("--sequences", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    dice = random.Random(given.seed)
    with tempfile.TemporaryDirectory() as folder:
        # Beside it lie the character and the clips.
        shutil.copytree(given.dataset.parent, pathlib.Path(folder) / "all", symlinks=True)
        session = Session(str(pathlib.Path(given.program).resolve()), pathlib.Path(folder) / "all" / given.dataset.name)
        raw, manifest = hashes(session.folder), (session.folder / "dataset.json").read_bytes()
        begun = time.monotonic()
        session.run(["list", "DATASET"])
        usual = time.monotonic() - begun
        for sequence in range(given.sequences):
            for _ in range(dice.randint(2, 4)):
                words = edit(session.stack(), dice)
                if dice.random() < 0.4:
                    session.kill(words, dice.uniform(0, 1.5 * usual))
                else:
                    session.run(words)
            while session.run(["undo", "DATASET"]) != REFUSED:
                pass
            if (session.folder / "dataset.json").read_bytes() != manifest:
                sys.exit(f"sequence {sequence}: undone to its end, dataset.json is not what it was")
            if hashes(session.folder) != raw:
                sys.exit(f"sequence {sequence}: a raw cache has changed")
        print(f"{given.sequences} sequences, {session.edits} edits, {session.kills} killed: "
              "every stack was the old one or the new one, all undone to the byte, raw caches unchanged")


if __name__ == "__main__":
    main()
