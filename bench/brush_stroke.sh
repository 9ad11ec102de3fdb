#!/usr/bin/env bash
# bench/brush_stroke.sh DATASET [BRUSH] [PICTURE.png]: a brush goes to and fro over the middle of a dataset's skin, in a window
# of 960 x 540 that nobody sees (Xvfb, xdotool). The picture, taken while it is pressed, has the pictures a second among its
# figures. The stroke is taken back. Says how long the first picture took.
set -euo pipefail
dataset=$(realpath "$1")
brush=${2:-inflate}
picture=$(realpath "${3:-brush_stroke.png}")
bodyopt=$(realpath "${BODYOPT:-$(dirname "$0")/../build/release/bin/bodyopt}")
folder=$(mktemp -d)
cd "$folder"
Xvfb -displayfd 3 -noreset -screen 0 1000x600x24 -nolisten tcp 3>number 2>/dev/null &
display=$!
trap 'kill $program $display 2>/dev/null; rm -rf "$folder"' EXIT
until [ -s number ]; do sleep 0.1; done
export DISPLAY=:$(cat number)
start=$(date +%s.%N)
"$bodyopt" view "$dataset" --size 960 540 --no-vsync \
  --do "section curate; layout hold; brush $brush; brush-strength 0.2; screenshot ready.png" >log 2>&1 &
program=$!
until [ -e ready.png ]; do
  kill -0 $program || { cat log; exit 1; }
  sleep 0.02
done
echo "first picture: $(echo "$(date +%s.%N) - $start" | bc) s"
window=$(xdotool search --onlyvisible --name Bodyopt | head -1)
stroke=""
for k in $(seq 1 300); do
  [ "$k" = 280 ] && stroke+=" key F12"
  stroke+=" mousemove --window $window $((344 + (k % 80 < 40 ? k % 40 : 40 - k % 40) / 2)) $((190 + k % 100 / 2)) sleep 0.012"
done
xdotool windowfocus "$window" mousemove --window "$window" 344 200 sleep 3 mousedown 1
xdotool $stroke mouseup 1 sleep 2 key ctrl+z sleep 2 key ctrl+q
wait $program || true
cp bodyopt.0001.png "$picture"
echo "wrote $picture"
