#!/usr/bin/env bash
# A show on a real Slurm of three virtual nodes: submitted, damaged, retried; every output as an undisturbed run makes it.
. "$(dirname "$0")/head.bash"

show() {
  "$bodyopt" demo --quick --out "$folder/demo" >/dev/null
  cat >"$folder/shots.json" <<EOF
{"schema": "bodyopt-shots-1",
 "defaults": {"basis": "demo/basis.safetensors", "clip": "demo/heldout.glb", "device": "cpu", "out": "out/{shot}.pc2"},
 "elements": [{"shot": "a 'b' \$(touch hit)", "element": "arm"}, {"shot": "long", "element": "arm", "frame_ms": 1000}]}
EOF
}

# Until the queue is empty, for a minute at most.
wait_for_queue() {
  for _ in $(seq 120); do
    [ -z "$(squeue --me --noheader)" ] && return
    sleep 0.5
  done
  echo "the queue did not run empty" >&2
  exit 1
}

on_slurm() {
  "$bodyopt" farm plan "$folder/shots.json" --out "$folder/plan" --task-minutes 0.2
  "$bodyopt" farm submit "$folder/plan" --slurm
  wait_for_queue
  printf 'rot!' | dd of="$folder/out/long.pc2" bs=1 seek=100 conv=notrunc status=none
  rm "$folder/out/a 'b' \$(touch hit).pc2"
  "$bodyopt" farm retry "$folder/plan" --slurm
  wait_for_queue
  "$bodyopt" farm retry "$folder/plan" --slurm | grep -q "nothing is left to do"
  "$bodyopt" farm status "$folder/plan" | grep -q "done *2"
  "$bodyopt" farm cancel "$folder/plan"
  "$bodyopt" farm report "$folder/plan" --out "$folder/show.html"
  [ "$(grep -o '"state":"done"' "$folder/show.html" | wc -l)" = 2 ]
  "$bodyopt" farm submit "$folder/plan" --openjd "$folder/job.json"
  if "$bodyopt" farm submit "$folder/plan" --opencue "$folder/job.xml"; then
    [ "$(id -u)" -ne 0 ] # OpenCue takes no jobs of root
  fi
  "$bodyopt" eval "$folder/demo/basis.safetensors" --clip "$folder/demo/heldout.glb" --device cpu --out "$folder/truth.pc2"
  for output in "$folder"/out/*.pc2; do cmp "$output" "$folder/truth.pc2"; done
  ! find "$folder" -name hit | grep -q .
}

if [ "${1:-}" = inside ]; then
  folder=$2
  trap - EXIT
  on_slurm
  exit
fi
show
code=0
scripts/farm-demo tests/other_programs/slurm.sh inside "$folder" || code=$?
if [ "$code" = 77 ]; then
  echo "skipped: Slurm cannot be started here"
  exit 0
fi
exit "$code"
