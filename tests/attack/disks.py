"""Disks that are full or read-only, and `ulimit -f`: a verb that cannot write says so and leaves what was there; with room
again it leaves the bytes of an undisturbed run."""
import os
import shutil
import subprocess

from kills import check_outcome
from running import run
from stage import VERBS, contents, is_temporary

NAME = "disks"
_REFUSED = (4, 75)  # a file cannot be written; interrupted


def attack(stage, findings, random, clock, _tools):
    disk = SmallDisk(stage.folder / "disk")
    if not disk.possible:
        findings.note("disks: no tmpfs can be mounted here (root may): full disks are left out, `ulimit -f` is not")
    verbs = []
    try:
        while not clock.over():
            if not verbs:
                verbs = random.sample(VERBS, len(VERBS))
            verb, share = verbs.pop(), random.random()
            limited(stage, findings, verb, share)
            if disk.possible and not clock.over():
                full(stage, findings, verb, share, disk)
                read_only(stage, findings, verb, disk)
    finally:
        disk.give_back()


def limited(stage, findings, verb, share):
    """No file may grow beyond a share of the largest that the verb writes."""
    expected, _ = stage.undisturbed(verb)
    written = [len(data) for name, data in expected.items() if data != stage.files.get(name)]
    # An update without new frames leaves the bytes that were there: any file may be the one it writes.
    most = int(share * max(written or map(len, expected.values())))
    work = stage.copy(verb=verb)
    outcome = run(stage.command(verb.arguments), work, most_bytes=most)
    judge(stage, findings, verb, f"{verb.name}, files of {most} bytes at most", outcome, work, expected)


def full(stage, findings, verb, share, disk):
    """The disk has room for a share of what the verb adds."""
    expected, _ = stage.undisturbed(verb)
    added = sum(len(data) for name, data in expected.items() if data != stage.files.get(name))
    disk.resize(1 << 30)
    work = disk.folder / "work"
    shutil.rmtree(work, ignore_errors=True)
    shutil.copytree(stage.base, work)
    stage.prepare(verb, work)
    disk.resize(disk.used() + int(share * added))
    outcome = run(stage.command(verb.arguments), work)
    disk.resize(1 << 30)
    judge(stage, findings, verb, f"{verb.name}, on a disk with room for {share:.0%}", outcome, work, expected)


def read_only(stage, findings, verb, disk):
    """Nothing can be written in the folder."""
    expected, _ = stage.undisturbed(verb)
    work = disk.folder / "work"
    shutil.rmtree(work, ignore_errors=True)
    shutil.copytree(stage.base, work)
    stage.prepare(verb, work)
    disk.become("ro")
    outcome = run(stage.command(verb.arguments), work)
    disk.become("rw")
    judge(stage, findings, verb, f"{verb.name}, on a read-only disk", outcome, work, expected)


def judge(stage, findings, verb, what, outcome, work, expected, name=NAME, refused=_REFUSED):
    """What a verb that could not do its work must leave, and what the next run makes of that."""
    findings.attempt(name)
    evidence = [work]
    if not findings.ended(name, outcome, evidence) and outcome.code not in (0,) + refused:
        findings.add(name, "losses", f"{what}: refused by another exit code than {refused}", evidence, outcome.text())
    stranded = sorted(path for path in contents(work).keys() - stage.files.keys() if is_temporary(path))
    if stranded:
        findings.add(name, "stranded", f"{what}: {', '.join(stranded)}", evidence, outcome.text())
    for wrong in stage.unreadable(work):
        findings.add(name, "losses", f"{what}: {wrong}", evidence, outcome.text())
    if outcome.code == 0 and verb.once:
        return
    again = run(stage.command(verb.arguments), work)
    if not findings.ended(name, again, evidence):
        check_outcome(findings, name, what, verb, again, work, expected, stranded)


class SmallDisk:
    """A tmpfs, which root may mount."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir()
        self.possible = self._mount("size=1g")

    def resize(self, size):
        self.become(f"size={size}")

    def become(self, options):
        self._mount(f"remount,{options}")

    def used(self):
        status = os.statvfs(self.folder)
        return (status.f_blocks - status.f_bfree) * status.f_frsize

    def give_back(self):
        if self.possible:
            subprocess.run(["umount", self.folder], check=True)

    def _mount(self, options):
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "bodyopt_attack", self.folder],
                                 stderr=subprocess.DEVNULL, check=False)
        return mounted.returncode == 0
