"""libFuzzer on every reader of bytes from outside (tests/fuzz)."""
import os
import re
import shutil

from running import run

NAME = "fuzz"
# Readers that write sound files at random and read them back: what they come to depends on how many there are.
SOUND = ("known_motion", "random_fbx", "random_gltf", "random_shapes")
SOUND_FILES, SOUND_MINUTES = 10000, 10  # of each, unless the attack is shorter


def attack(stage, findings, random, clock, tools):
    """Every reader gets the same share of the time, so that a reader's executions depend on the seed and on how fast
    the machine is alone. Those of sound files come last, and take the time that they need."""
    folder = stage.folder / "fuzz"
    temporary = folder / "tmp"
    temporary.mkdir(parents=True)
    files = findings.folder.parent / "fuzz_files"  # kept: what is found is read again with them
    shutil.copytree(stage.for_fuzzers, files)
    environment = dict(os.environ, BODYOPT_FUZZ_FILES=str(files), TMPDIR=str(temporary))
    listed = run([tools.fuzzer, "--list"], folder)
    made = run([tools.fuzzer, "--write-seeds=seeds"], folder, environment=environment)
    if listed.code != 0 or made.code != 0:
        raise SystemExit(f"the fuzzers cannot begin: {made.text()}")
    readers = listed.output.split()
    random.shuffle(readers)
    counted = SOUND if tools.minutes >= SOUND_MINUTES else ()
    timed = [reader for reader in readers if reader not in counted]
    for k, reader in enumerate(timed):
        seconds = clock.left() / (len(timed) - k)
        limit = f"-max_total_time={max(1, int(seconds))}"
        fuzz(findings, tools.fuzzer, environment, folder, reader, random.getrandbits(31), limit, seconds)
    for reader in counted:
        fuzz(findings, tools.fuzzer, environment, folder, reader, random.getrandbits(31), f"-runs={SOUND_FILES}", 7200)


def fuzz(findings, fuzzer, environment, folder, reader, seed, limit, seconds):
    corpus, found = folder / "corpus" / reader, folder / "found" / reader
    corpus.mkdir(parents=True)
    found.mkdir(parents=True)
    largest = max(path.stat().st_size for path in (folder / "seeds" / reader).iterdir())
    words = folder / "seeds" / f"{reader}.dict"
    dictionary = [f"-dict={words}"] if words.stat().st_size > 0 else []  # libFuzzer refuses an empty one
    command = [fuzzer, f"--reader={reader}", f"-seed={seed}", limit,
               f"-max_len={max(2 * largest, 4096)}", *dictionary, f"-artifact_prefix={found}/", "-timeout=20",
               "-rss_limit_mb=3000", "-malloc_limit_mb=1000", corpus, folder / "seeds" / reader]
    outcome = run(command, folder, seconds=seconds + 120, environment=environment)
    executed = re.findall(r"^#(\d+)", outcome.output, re.M)
    findings.attempt(NAME, int(executed[-1]) if executed else 0)
    if outcome.code == 0 and not outcome.hung:
        shutil.rmtree(corpus)
        return
    kind = "hangs" if outcome.hung or "ERROR: libFuzzer: timeout" in outcome.output else "crashes"
    if "NaN: accepted" in outcome.output:
        kind = "NaN"
    again = f"BODYOPT_FUZZ_FILES={environment['BODYOPT_FUZZ_FILES']} {fuzzer} --reader={reader} FILE"
    findings.add(NAME, kind, f"reader {reader}: {first_cause(outcome.output)}", sorted(found.iterdir()),
                 f"{again}\n\n{outcome.text()}")


def first_cause(output):
    for pattern in (r"NaN: accepted.*", r"MEMORY: .*", r"WRONG: .*", r"wrong motion: .*", r"runtime error: .*", r"what\(\): .*", r"SUMMARY: .*", r"ERROR: .*"):
        found = re.search(pattern, output)
        if found:
            return found.group(0)
    return "see what.txt"
