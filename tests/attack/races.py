"""Eight processes at once on one dataset, on one file of attachments, on one output; others read meanwhile. Who says
that it is done must have left what it did."""
import json

from running import Running, run
from stage import VERBS, contents, different, is_temporary

NAME = "races"
TOGETHER = 8


def attack(stage, findings, random, clock, _tools):
    races = []
    while not clock.over():
        if not races:
            races = random.sample([simulate, add, simulate_and_add, attach, evaluate, train], 6)
        races.pop()(stage, findings, random)


def simulate(stage, findings, random):
    race_for_takes(stage, findings, random, "simulate", [simulation(k, random) for k in range(TOGETHER)])


def add(stage, findings, random):
    race_for_takes(stage, findings, random, "dataset add", [addition(k) for k in range(TOGETHER)])


def simulate_and_add(stage, findings, random):
    half = TOGETHER // 2
    race_for_takes(stage, findings, random, "simulate and dataset add",
                   [simulation(k, random) for k in range(half)] + [addition(k) for k in range(half, TOGETHER)])


def simulation(k, random):
    first = random.randint(1, 40)
    last = first + random.randint(0, 5)
    return (f"simulate limb.glb --clip bend.glb --tet-size 0.2 --threads 1 --frames {first}-{last} --out elsewhere "
            f"--name take{k}")


def addition(k):
    return f"dataset add elsewhere --clip bend.glb --frames 1-6 --shapes shapes{k}.pc2 --name take{k}"


def race_for_takes(stage, findings, random, what, commands):
    work, outcomes = race(stage, findings, random, commands, "check elsewhere")
    try:
        names = {take["name"] for take in json.loads((work / "elsewhere/dataset.json").read_text())["takes"]}
    except (OSError, ValueError, KeyError) as error:
        names = {f"unreadable: {error}"}
    done = {f"take{k}" for k, outcome in enumerate(outcomes) if outcome.code == 0} | {"s0"}
    lost(findings, what, sorted(done - names), work, outcomes)
    sound(stage, findings, what, "check elsewhere", work)


def attach(stage, findings, random):
    commands = [f"attach prop{k}.glb limb.safetensors" for k in range(TOGETHER)]
    work, outcomes = race(stage, findings, random, commands, "info limb.safetensors")
    info = run(stage.command("info limb.attached.safetensors --json -"), work)
    done = {f"prop{k}" for k, outcome in enumerate(outcomes) if outcome.code == 0}
    lost(findings, "attach", sorted(name for name in done if f'"{name}"' not in info.output), work, outcomes)
    sound(stage, findings, "attach", "info limb.attached.safetensors", work)


def evaluate(stage, findings, random):
    commands = ["eval limb.safetensors --clip bend.glb --device cpu --out shot.pc2"] * TOGETHER
    work, outcomes = race(stage, findings, random, commands, "info shot.pc2")
    if (work / "shot.pc2").read_bytes() != stage.files["shot.pc2"]:
        lost(findings, "eval", ["shot.pc2"], work, outcomes)


def train(stage, findings, random):
    """Of one store: each finds what the others kept."""
    verb = next(verb for verb in VERBS if verb.name == "train")
    expected, _ = stage.undisturbed(verb)
    work, outcomes = race(stage, findings, random, [verb.arguments] * (TOGETHER // 2), "info limb.safetensors")
    lost(findings, "train", different(contents(work), expected), work, outcomes)


def race(stage, findings, random, commands, reading):
    """Runs them at once, and the reading again and again beside them, which must never fail."""
    work = stage.copy()
    before = contents(work).keys()
    order = random.sample(range(len(commands)), len(commands))
    running = {k: Running(stage.command(commands[k]), work) for k in order}
    while any(one.process.poll() is None for one in running.values()):
        reader = run(stage.command(reading), work)
        if not findings.ended(NAME, reader, [work]) and reader.code != 0:
            findings.add(NAME, "losses", f"{reading}, while others write", [work], reader.text())
        if any(one.process.poll() is None and one.seconds() > 60 for one in running.values()):
            break
    outcomes = [running[k].wait() for k in range(len(commands))]
    findings.attempt(NAME)
    for outcome in outcomes:
        # One may be asked to wait until another run has ended; any other refusal is of a file that is sound.
        if not findings.ended(NAME, outcome, [work]) and outcome.code != 0 and "another run" not in outcome.output:
            findings.add(NAME, "losses", f"refused: {' '.join(outcome.command[1:])}", [work], outcome.text())
    new = contents(work).keys() - before
    stranded = sorted(name for name in new if is_temporary(name) or name.endswith(".partial"))
    if stranded:
        findings.add(NAME, "stranded", ", ".join(stranded), [work])
    return work, outcomes


def lost(findings, what, names, work, outcomes):
    if names:
        findings.add(NAME, "losses", f"{what}: exit code 0, and gone: {', '.join(names)}", [work],
                     "\n".join(outcome.text() for outcome in outcomes))


def sound(stage, findings, what, reading, work):
    reader = run(stage.command(reading), work)
    if not findings.ended(NAME, reader, [work]) and reader.code != 0:
        findings.add(NAME, "losses", f"{what}: the result cannot be read", [work], reader.text())
