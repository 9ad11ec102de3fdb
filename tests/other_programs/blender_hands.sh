#!/usr/bin/env bash
# In a window, by keys: a squat over both feet, keyed, saved, one more key, and the viewport is killed. The next one brings
# that back and exports it, and Blender has every vertex where Bodyopt has it. A sculpt on a dataset's worst frame outlives
# the same. `blender_hands.sh DEMO` sculpts in a copy of what `bodyopt demo --quick` left there.
. "$(dirname "$0")/blender.bash"
needs Xvfb xdotool
data=${BODYOPT_SHARED_DATA:-../shared/data}
[ -f "$data/characters/human_average.glb" ] || { echo "skipped: needs a real body from BODYOPT_SHARED_DATA"; exit 0; }
cp "$data/characters/human_average.glb" "$folder/hero.glb"
cp rigs/human/limits.json "$folder/"
export XDG_CACHE_HOME=$folder/cache
Xvfb -displayfd 3 -screen 0 960x600x24 3>"$folder/display" 2>/dev/null &
server=$!
trap 'kill $server; rm -rf "$folder"' EXIT

# until_true COMMAND...: waits for it, a minute and a half at most.
until_true() {
  local k
  for k in $(seq 900); do "$@" && return; sleep 0.1; done
  echo "in vain: $*" >&2
  return 1
}
until_true test -s "$folder/display"
export DISPLAY=:$(cat "$folder/display")
window_is_there() { xdotool search --name Bodyopt >/dev/null 2>&1; }
# open FILE...: a viewport that hears keys.
open() {
  $bodyopt view "$@" --size 960 600 >"$folder/view.txt" 2>&1 &
  viewport=$!
  until_true window_is_there
  sleep 3
  xdotool windowfocus "$(xdotool search --name Bodyopt | tail -1)"
}
run() { # COMMAND: by the prompt
  xdotool key Return sleep 0.3 type --delay 15 -- "$1"
  xdotool key Return sleep 0.3
}
die() {
  kill -9 $viewport
  wait $viewport || true
}

open "$folder/hero.glb"
for command in "pin LeftFoot" "pin RightFoot" key "frame 12" "move Hips 0 -0.35 0" key "frame 24" "move Hips 0 0 0" \
  "turn RightArm 0 0 -50" key copy "frame 36" paste-flipped key "in 1" "out 36" "save $folder/wave.json"; do
  run "$command"
done
until_true test -f "$folder/wave.json"
run "frame 30"
run "turn Head 0 25 0"
run key
is_autosaved() { grep -qs '"30"' "$XDG_CACHE_HOME"/bodyopt/*.unsaved.json; }
until_true is_autosaved
die
grep -q '"30"' "$folder/wave.json" && { echo "it was saved after all"; exit 1; }
open "$folder/hero.glb"
run recover
run "export-skin $folder/wave.pc2"
run "export-skin $folder/wave.glb"
until_true test -f "$folder/wave.glb"
die
in_blender blender_skin.py "$folder/wave.glb" "$folder/wave.pc2" 36

if [ $# -gt 0 ]; then
  cp -r "$1" "$folder/demo"
else
  $bodyopt demo --quick --out "$folder/demo" >/dev/null 2>&1
fi
set_of=$folder/demo/dataset
open "$folder/demo/basis.safetensors" "$set_of"
run worst-frame
sleep 5
run "brush grab"
run "stroke 0.87 0.44 0.9 0.44"
edited() { $bodyopt curate list "$set_of" 2>/dev/null | grep -q sculpt; }
until_true edited
die
edited
echo "the sculpt outlived the viewport"
