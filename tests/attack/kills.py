"""Verbs that write are killed at some moment. What was there must still be readable, and a second run must leave the
bytes of an undisturbed one, and no file besides."""
from running import run
from stage import VERBS, contents, different, not_finite

NAME = "kills"


def attack(stage, findings, random, clock, _tools):
    verbs = []
    while not clock.over():
        if not verbs:  # every verb once before any is killed again
            verbs = random.sample(VERBS, len(VERBS))
        kill(stage, findings, verbs.pop(), random.random())


def kill(stage, findings, verb, share):
    expected, seconds = stage.undisturbed(verb)
    work = stage.copy(verb=verb)
    command = stage.command(verb.arguments)
    after = max(share * seconds, 0.001)
    killed = run(command, work, kill_after=after)
    if findings.ended(NAME, killed, [work]) or not killed.killed:
        return  # it was quicker than the kill
    findings.attempt(NAME)
    what = f"{verb.name}, killed after {after:.3f} s"
    for wrong in stage.unreadable(work):
        findings.add(NAME, "losses", f"{what}: {wrong}", [work], killed.text())
    again = run(command, work)
    if findings.ended(NAME, again, [work]):
        return
    check_outcome(findings, NAME, what, verb, again, work, expected)


def check_outcome(findings, attack_name, what, verb, outcome, work, expected, known=()):
    """What a run that nothing disturbs must leave. `known`: stranded files that are counted already."""
    found = contents(work)
    wrong = different(found, expected) if verb.same_bytes or outcome.code != 0 else []
    if outcome.code != 0 and not (verb.once and not wrong):
        findings.add(attack_name, "losses", f"{what}: the next run fails", [work], outcome.text())
    elif wrong:
        findings.add(attack_name, "losses", f"{what}: other bytes than undisturbed: {', '.join(wrong)}", [work])
    stranded = sorted(found.keys() - expected.keys() - set(known))
    if not verb.same_bytes:
        # It may take other steps than undisturbed, and name files by them.
        stranded = [name for name in stranded if name.startswith(".") or "/." in name or ".tmp" in name]
    if stranded:
        findings.add(attack_name, "stranded", f"{what}: {', '.join(stranded)}", [work], outcome.text())
    for name in not_finite(work):
        findings.add(attack_name, "NaN", f"{what}: {name}", [work])
