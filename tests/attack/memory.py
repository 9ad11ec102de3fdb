"""Less memory than a verb takes (`ulimit -v`): it says so and leaves what was there; with enough again it leaves the bytes
of an undisturbed run."""
from disks import judge
from running import run
from stage import VERBS

NAME = "memory"
# As docs/verbs.md has them; 127 where not even the program's libraries can be loaded.
_REFUSED = (4, 5, 75, 127)
_LEAST, _MOST = 100e6, 4e9  # bytes of addresses
# Mesa's own compiler aborts the process where it gets no memory.
_ON_A_DEVICE = ("view", "picture", "--picture", "--report")


def attack(stage, findings, random, clock, _tools):
    on_the_cpu = [verb for verb in VERBS if not any(word in _ON_A_DEVICE for word in verb.arguments.split())]
    verbs = []
    while not clock.over():
        if not verbs:
            verbs = random.sample(on_the_cpu, len(on_the_cpu))
        verb, most = verbs.pop(), int(_LEAST * (_MOST / _LEAST) ** random.random())
        expected, _ = stage.undisturbed(verb)
        work = stage.copy(verb=verb)
        outcome = run(stage.command(verb.arguments), work, most_memory=most)
        judge(stage, findings, verb, f"{verb.name}, in {most / 1e6:.0f} MB", outcome, work, expected, NAME, _REFUSED)
