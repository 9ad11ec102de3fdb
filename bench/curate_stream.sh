#!/usr/bin/env bash
# bench/curate_stream.sh CHARACTER LIMITS [FRAMES] [FOLDER]: 3,200 frames of a character through five modifiers, once
# more, and after edits. The shapes are made up: Direct Delta Mush of its range of motion. Says seconds and the most that was resident.
set -euo pipefail
character=$(realpath "$1")
limits=$(realpath "$2")
frames=${3:-3200}
folder=${4:-$(mktemp -d)}
bodyopt=${BODYOPT:-$(dirname "$0")/../build/release/bin/bodyopt}
mkdir -p "$folder"
timed() {
  local name=$1
  shift
  /usr/bin/env python3 - "$name" "$@" <<'PYTHON'
import resource, subprocess, sys, time
start = time.monotonic()
subprocess.run(sys.argv[2:], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
usage = resource.getrusage(resource.RUSAGE_CHILDREN)
print(f"{sys.argv[1]}: {time.monotonic() - start:.1f} s, {usage.ru_utime + usage.ru_stime:.1f} core seconds, "
      f"{usage.ru_maxrss / 2**20:.2f} GiB resident at most")
PYTHON
}
if [ ! -e "$folder/data/dataset.json" ]; then
  $bodyopt rom "$character" --limits "$limits" --frames "$frames" --out "$folder/rom.glb" >/dev/null
  $bodyopt train --ddm-only "$character" --out "$folder/ddm.safetensors" >/dev/null
  $bodyopt eval "$folder/ddm.safetensors" --clip "$folder/rom.glb" --device cpu --out "$folder/shapes.pc2" >/dev/null
  $bodyopt dataset add "$folder/data" --character "$character" --clip "$folder/rom.glb" --shapes "$folder/shapes.pc2" \
    --frames "1-$frames" --name rom >/dev/null
  rm "$folder/shapes.pc2"
fi
data=$folder/data
for type in smooth relax volume inflate; do $bodyopt curate add "$data" $type --strength 0.5 >/dev/null; done
$bodyopt curate export-frame "$data" --take rom --frame 100 --out "$folder/frame.obj" >/dev/null
awk '/^v / && ++count <= 1000 { $3 += 0.005 } { print }' "$folder/frame.obj" >"$folder/sculpt.obj"
$bodyopt curate import-frame "$data" --take rom --frame 100 --mesh "$folder/sculpt.obj" --name sculpt --spread 0 >/dev/null
bake() {
  rm -rf "$folder/baked"
  timed "$1" "$bodyopt" curate bake "$data" --out "$folder/baked"
}
bake "$frames frames through five modifiers"
bake "once more"
$bodyopt curate edit "$data" sculpt --strength 0.7 >/dev/null
bake "after an edit of the last"
$bodyopt curate move "$data" sculpt 1 >/dev/null
bake "with the sculpt of one frame below the others"
$bodyopt curate edit "$data" smooth --strength 0.6 >/dev/null
bake "after an edit of the first that takes long"
timed "one frame" "$bodyopt" curate export-frame "$data" --take rom --frame 100 --out "$folder/frame.obj"
echo "kept: $(du -sh "$data/modifiers/cache" | cut -f1)"
