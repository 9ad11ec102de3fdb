#!/usr/bin/env python3
"""How long frames take with the runtime of an earlier commit, and with that of the sources as they are.
  scripts/bench --against COMMIT BASIS [DYNAMICS]
The earlier runtime is built in a git worktree of its own, which is removed again. Both run in turns, so that what else the
machine does falls on both; the quickest of all counts. Prints a table: ms a frame, and how many
times quicker. BASIS and DYNAMICS have to be files that the earlier runtime reads, too. Exits with 2 where a run of either
fails, after the table of what was measured.
"""
import argparse, os, pathlib, signal, subprocess, sys, tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
ROUNDS = 5
SINGLE, TOGETHER, JIGGLING = "one frame", "frames of 16", "frames that jiggle"
# Title, what frame_bench calls it, its stages.
STAGES = [
    ("`strain` and `pose`", SINGLE, ("strain", "pose")),
    ("`residual`", SINGLE, ("residual",)),
    ("`diffuse`", JIGGLING, ("diffuse",)),
    ("`jiggle`", JIGGLING, ("jiggle",)),
]
FRAMES = [
    (f"{title}, {where}", what, (stage,))
    for title, what in (("static frame", SINGLE), ("static frame of 16", TOGETHER), ("frame of 16 that jiggle", JIGGLING))
    for where, stage in (("on the clock", "clock"), ("of the processors", "processors"))
]


def stop(message):
    print(f"bench: {message}", file=sys.stderr)
    sys.exit(2)


def build(tree, folder):
    """frame_bench of the sources `tree`, or None where they have not what it takes."""
    steps = (["cmake", "-S", HERE, "-B", folder, "-G", "Ninja", f"-DTREE={tree}"], ["cmake", "--build", folder])
    for step in steps:
        done = subprocess.run(step, capture_output=True, text=True)
        if done.returncode != 0:
            print((done.stdout + done.stderr)[-2000:], file=sys.stderr)
            return None
    return pathlib.Path(folder) / "frame_bench"


def run(program, threads, device, files):
    """{(what, stage): ms} on so many of the processors, and why the program failed; None where it did not."""
    cores = sorted(os.sched_getaffinity(0))[:threads]
    done = subprocess.run([program, device, *files], capture_output=True, text=True,
                          preexec_fn=lambda: os.sched_setaffinity(0, cores))
    rows = [line.split("\t") for line in done.stdout.splitlines()]
    failure = None if done.returncode == 0 else done.stderr.strip() or f"ended with {done.returncode}"
    return {(what, stage): float(ms) for what, stage, ms in rows}, failure


def measure(programs, threads, device, files):
    """Of each of the programs, in turns, the quickest of all rounds; and why any failed, as lines."""
    quickest, failures = [{} for _ in programs], set()
    for _ in range(ROUNDS):
        for best, program in zip(quickest, programs):
            figures, failure = run(program, threads, device, files)
            for key, ms in figures.items():
                best[key] = min(ms, best.get(key, ms))
            failures |= {f"{program}, device {device}: {failure}"} if failure else set()
    return quickest, sorted(failures)


def milliseconds(figures, what, stages):
    """The sum over those of the stages that there are; None without any."""
    found = [figures[what, stage] for stage in stages if (what, stage) in figures]
    return sum(found) if found else None


def print_rows(where, rows, earlier, now):
    for title, what, stages in rows:
        times = [milliseconds(figures, what, stages) for figures in (earlier, now)]
        if times == [None, None]:
            continue
        cells = ["not measured" if ms is None else f"{ms:.3f}" for ms in times]
        ratio = "" if None in times else f"{times[0] / times[1]:.2f} x"
        print(f"| {where} | {title} | {cells[0]} | {cells[1]} | {ratio} |")


def main():
    parser = argparse.ArgumentParser(prog="scripts/bench --against", description=__doc__.splitlines()[0])
    parser.add_argument("commit")
    parser.add_argument("files", nargs="+", metavar="BASIS [DYNAMICS]")
    arguments = parser.parse_args()
    for file in arguments.files:
        if not pathlib.Path(file).is_file():
            stop(f"there is no file {file}")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))  # the worktree is removed then, too
    with tempfile.TemporaryDirectory(prefix="bodyopt_against_") as folder:
        tree = f"{folder}/tree"
        added = subprocess.run(["git", "-C", ROOT, "worktree", "add", "--detach", tree, arguments.commit],
                               capture_output=True, text=True)
        if added.returncode != 0:
            stop(added.stderr.strip())
        try:
            compare(build(tree, f"{folder}/earlier"), build(ROOT, f"{folder}/now"), arguments)
        finally:
            subprocess.run(["git", "-C", ROOT, "worktree", "remove", "--force", tree], check=True)


def compare(earlier, now, arguments):
    if earlier is None:
        stop(f"the runtime of {arguments.commit} has not what bench/against/frame_bench.cpp takes, or does not build")
    if now is None:
        stop("the runtime as it is does not build")
    described = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--dirty"], check=True, capture_output=True,
                               text=True).stdout.strip()
    print(f"| where | ms a frame | {arguments.commit} | {described} | |\n|---|---|---|---|---|")
    # Of several threads of the CPU, the stages are sums over them.
    places = [("CPU, 1 thread", 1, "cpu", STAGES + FRAMES), ("CPU, 2 threads", 2, "cpu", FRAMES),
              ("device 0", os.cpu_count(), "0", STAGES + FRAMES)]
    failures = []
    for where, threads, device, rows in places:
        quickest, failed = measure((earlier, now), threads, device, arguments.files)
        print_rows(where, rows, *quickest)
        failures += failed
    if failures:
        stop("not all was measured\n" + "\n".join(failures))


main()
