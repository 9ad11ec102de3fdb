"""Runs programs: with a time limit, a limit of what they may write or allocate, or a kill at some moment."""
import os
import resource
import signal
import subprocess
import time

TIME_LIMIT = 60  # seconds; what the attack runs takes a second or two
DEFECT = 70  # the exit code by which bodyopt calls an error its own


class Outcome:
    def __init__(self, command, code, output, seconds, killed, hung):
        self.command, self.code, self.output, self.seconds = command, code, output, seconds
        self.killed, self.hung = killed, hung

    @property
    def crashed(self):
        if self.killed or self.hung:
            return False
        return self.code < 0 or self.code == DEFECT or "Sanitizer" in self.output

    def text(self):
        ended = "killed" if self.killed else "hung" if self.hung else f"exit code {self.code}"
        return f"{' '.join(self.command)}\n{ended} after {self.seconds:.2f} s\n{self.output}"


class Running:
    """A program that runs beside the attack."""

    def __init__(self, command, folder, most_bytes=None, most_memory=None, environment=None):
        def limit():
            if most_bytes is not None:
                resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))
            if most_memory is not None:
                resource.setrlimit(resource.RLIMIT_AS, (most_memory, most_memory))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

        self.command = [str(word) for word in command]
        self.begin = time.monotonic()
        # By a pipe: a file of the output would be under the limit, too.
        self.process = subprocess.Popen(
            self.command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            start_new_session=True, preexec_fn=limit, env=environment)

    def kill(self):
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass

    def seconds(self):
        return time.monotonic() - self.begin

    def wait(self, seconds=TIME_LIMIT, kill_after=None):
        killed = hung = False
        try:
            output, _ = self.process.communicate(timeout=kill_after or seconds)
        except subprocess.TimeoutExpired:
            killed, hung = kill_after is not None, kill_after is None
            self.kill()
            output, _ = self.process.communicate()
        return Outcome(self.command, self.process.returncode, output.decode(errors="replace"), self.seconds(), killed,
                       hung)


def run(command, folder, **limits):
    kill_after = limits.pop("kill_after", None)
    seconds = limits.pop("seconds", TIME_LIMIT)
    return Running(command, folder, **limits).wait(seconds, kill_after)
