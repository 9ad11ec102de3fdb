#!/usr/bin/env bash
# A frame goes to Blender, is sculpted there, comes back, and is what the dataset's frame is from then on; undone, the
# frame is what it was, bit for bit.
set -euo pipefail
cd "$(dirname "$0")/../.."
if ! command -v blender >/dev/null; then
  echo "skipped: blender is not installed (scripts/test --all installs it)"
  exit 0
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bodyopt=build/release/bin/bodyopt
$bodyopt demo --quick --out "$folder" >/dev/null
frame="--take rom --frame 40"
$bodyopt curate export-frame "$folder" $frame --out "$folder/before.obj"
blender --background --factory-startup --python-exit-code 1 --python tests/other_programs/blender_sculpt.py -- \
  "$folder/before.obj" "$folder/sculpt.obj" >/dev/null
$bodyopt curate import-frame "$folder" $frame --mesh "$folder/sculpt.obj" --name sculpt --spread 20
$bodyopt curate export-frame "$folder" $frame --out "$folder/after.obj"
python3 - "$folder/sculpt.obj" "$folder/after.obj" "$folder/before.obj" <<'PYTHON'
import sys

sculpt, after, before = (
    [[float(x) for x in line.split()[1:4]] for line in open(path) if line.startswith("v ")] for path in sys.argv[1:])
def worst(a, b):
    return max(abs(x - y) for p, q in zip(a, b) for x, y in zip(p, q))
print(f"sculpted by {1e3 * worst(sculpt, before):.2f} mm, read back to {1e3 * worst(sculpt, after):.5f} mm")
assert worst(sculpt, before) > 5e-3, "Blender changed nothing"
assert worst(sculpt, after) < 1e-5, "the frame is not what was sculpted"
PYTHON
$bodyopt curate undo "$folder"
$bodyopt curate export-frame "$folder" $frame --out "$folder/undone.obj"
cmp "$folder/before.obj" "$folder/undone.obj"
