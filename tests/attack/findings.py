"""What the attacks found: counted for the table, and kept with what reproduces it."""
import shutil

MOST_EVIDENCE = 40  # findings whose files are kept: the first of many are enough
KINDS = ("crashes", "hangs", "losses", "NaN", "stranded")


class Findings:
    def __init__(self, folder):
        self.folder = folder
        self.rows = {}  # by attack: attempts, and how many of each kind
        self.notes = []
        self.kept = []

    def attempt(self, attack, count=1):
        self._row(attack)["attempts"] += count

    def note(self, text):
        if text not in self.notes:
            self.notes.append(text)

    def add(self, attack, kind, what, evidence=(), text=""):
        """Counts it, and keeps copies of the files and folders that are its evidence. Gives the folder."""
        self._row(attack)[kind] += 1
        folder = self.folder / f"{len(self.kept) + 1:03}_{attack}_{kind}"
        folder.mkdir(parents=True)
        (folder / "what.txt").write_text(f"{what}\n\n{text}\n")
        for path in evidence if len(self.kept) < MOST_EVIDENCE else ():
            if path.is_dir():
                shutil.copytree(path, folder / path.name, symlinks=True)
            elif path.exists():
                shutil.copy(path, folder)
        self.kept.append((folder, f"{attack}: {kind}: {what}"))
        return folder

    def ended(self, attack, outcome, evidence=()):
        """Counts a crash or a hang of a program. True where there was one."""
        if outcome.hung:
            self.add(attack, "hangs", " ".join(outcome.command), evidence, outcome.text())
        elif outcome.crashed:
            how = f"signal {-outcome.code}" if outcome.code < 0 else f"exit code {outcome.code}"
            self.add(attack, "crashes", f"{how}: {' '.join(outcome.command)}", evidence, outcome.text())
        return outcome.hung or outcome.crashed

    def table(self):
        names = ("attempts",) + KINDS
        lines = ["| attack | " + " | ".join(names) + " |", "|---|" + "--:|" * len(names)]
        for attack, row in self.rows.items():
            lines.append(f"| {attack} | " + " | ".join(f"{row[name]:,}" for name in names) + " |")
        total = {name: sum(row[name] for row in self.rows.values()) for name in names}
        lines.append("| all | " + " | ".join(f"{total[name]:,}" for name in names) + " |")
        lines += [""] + self.notes
        lines += [f"{what.splitlines()[0][:200]}\n    {folder}" for folder, what in self.kept]
        return "\n".join(lines)

    def _row(self, attack):
        return self.rows.setdefault(attack, dict.fromkeys(("attempts",) + KINDS, 0))
