"""The verbs of the program `bodyopt` from Python: run("train", "dataset", out="hero.safetensors")."""

import json
import os
import pathlib
import re
import selectors
import shutil
import signal
import subprocess
import sys
import tempfile

from . import Error

_HERE = pathlib.Path(__file__).resolve().parent
_USAGE, _FILE, _INTERRUPTED = 64, 4, 75


def _refuse(code, message, result=None):
    error = Error(message)
    error.code, error.result = code, result
    return error


def program():
    """The program that run() runs: BODYOPT_PROGRAM, the wheel's own, or the one on PATH. Raises Error(4) without any."""
    own = _HERE / "program" / "bin" / "bodyopt"
    found = os.environ.get("BODYOPT_PROGRAM") or (str(own) if own.is_file() else shutil.which("bodyopt"))
    if not found:
        raise _refuse(_FILE, "there is no program 'bodyopt' on PATH: install the wheel, or name it by BODYOPT_PROGRAM")
    return found


def _environment(path):
    """Of the program: progress as JSON, and the libraries that the wheel brings for it."""
    environment = {**os.environ, "BODYOPT_PROGRESS": "json"}
    if pathlib.Path(path).is_relative_to(_HERE):
        before = environment.get("LD_LIBRARY_PATH")
        environment["LD_LIBRARY_PATH"] = str(_HERE) + (f":{before}" if before else "")
    return environment


def _words(options):
    """clip="a.glb" is --clip a.glb, tolerance=2 is --tolerance 2, jiggle=True is --jiggle, a list is its items."""
    for name, value in options.items():
        if value is None or value is False:
            continue
        yield "--" + name.rstrip("_").replace("_", "-")
        if value is not True:
            yield from (os.fspath(v) if isinstance(v, os.PathLike) else str(v)
                        for v in (value if isinstance(value, (list, tuple)) else [value]))


def _last_error(lines):
    """What a verb said on standard error last: from its 'error:' on, or all that there is."""
    text = "\n".join(lines).strip()
    found = re.split(r"^error: ", text, flags=re.MULTILINE)
    return found[-1].strip() if len(found) > 1 else text


def run(verb, *arguments, progress=None, cancelled=None, **options):
    """Runs a verb and returns its JSON: run("eval", "hero.safetensors", clip="walk.glb", out="walk.pc2").

    progress(what, done, total, seconds) is called about once a second; cancelled() is asked as often, and ends the verb
    where it is true. What the verb warns of goes to sys.stderr. Other Python threads run meanwhile. Raises Error with the
    verb's exit code and message, and its JSON, where it wrote any, as `result`.
    """
    if verb in ("view", "help"):
        raise _refuse(_USAGE, f"'{verb}' gives no JSON: run the program itself, {program()}")
    path, said = program(), []
    stopped = _refuse(_INTERRUPTED, f"{verb}: interrupted; nothing of it is kept")
    if cancelled and cancelled():
        raise stopped
    with tempfile.TemporaryDirectory() as folder:
        answer = pathlib.Path(folder) / "answer.json"
        words = [path, verb, *map(os.fspath, arguments), *_words(options), "--json", str(answer)]
        with subprocess.Popen(words, env=_environment(path), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
            is_told = _follow(process, progress, cancelled, said)
        try:
            result = json.loads(answer.read_text())
        except (OSError, ValueError):
            result = None
    code = process.returncode
    if is_told and code == -signal.SIGTERM:  # before it could take notice
        raise stopped
    if code != 0:
        raise _refuse(code, _last_error(said) or f"'{verb}' ended with {code}", result)
    return result


def _follow(process, progress, cancelled, said):
    """Reads a verb's standard error to its end. Returns whether the verb was told to stop.

    Ctrl-C and what a callback raises tell it, too, and are raised once it has ended; the second of them ends it at once.
    """
    is_told, raised, rest = False, None, b""
    with selectors.DefaultSelector() as selector:
        selector.register(process.stderr, selectors.EVENT_READ)
        while True:
            try:
                if cancelled and not is_told and cancelled():
                    process.terminate()
                    is_told = True
                if not selector.select(timeout=0.2):
                    continue
                piece = os.read(process.stderr.fileno(), 1 << 16)
                *lines, rest = (rest + piece).split(b"\n")
                for line in lines if piece else [rest]:
                    _take(line.decode(errors="replace"), None if raised else progress, said)
                if not piece:
                    break
            except BaseException as error:
                if raised:
                    process.kill()
                    raise
                raised = error
                if not is_told:
                    process.terminate()
                is_told = True
    if raised:
        raise raised
    return is_told


def _take(line, progress, said):
    """A line of progress, or a message: all but errors, which are raised, go on to sys.stderr."""
    if line.startswith('{"progress": '):
        step = json.loads(line)
        if progress:
            progress(step["progress"], step["done"], step["total"], step["seconds"])
    elif line.strip():
        said.append(line)
        if not line.startswith("error: "):
            print(line, file=sys.stderr)


def main():
    """The wheel's `bodyopt` on PATH."""
    path = program()
    os.execve(path, [path, *sys.argv[1:]], _environment(path) | {"BODYOPT_PROGRESS": ""})
