#!/usr/bin/env bash
# A frame goes to Blender, as OBJ and as glTF with its skeleton posed, is sculpted there and comes back with its vertices in
# another order: it is what the dataset's frame is from then on, and what a training learns of it; undone, the frame is what
# it was, bit for bit. `blender_sculpt.sh DEMO` works on a copy of what `bodyopt demo --quick` left there.
. "$(dirname "$0")/blender.bash"
if [ $# -gt 0 ]; then
  cp -r "$1/." "$folder"
else
  $bodyopt demo --quick --out "$folder" >/dev/null
fi
data=$folder/dataset
frame="--take rom --frame 40"

# largest A B: how far vertices of two OBJ files are apart at most, mm
largest() {
  python3 -c 'import math, sys
a, b = ([[float(x) for x in line.split()[1:4]] for line in open(path) if line.startswith("v ")] for path in sys.argv[1:])
moved = [1e3 * math.dist(p, q) for p, q in zip(a, b)]
assert len(a) == len(b) and sum(d > 0.01 for d in moved) < len(a) / 10, "other vertices moved, too"
print(f"{max(moved):.3f}")' "$1" "$2"
}

$bodyopt curate export-frame "$data" $frame --out "$folder/before.obj"
$bodyopt curate export-frame "$data" $frame --out "$folder/before.glb"
for format in obj glb; do
  in_blender blender_sculpt.py "$folder/before.$format" "$folder/sculpt.$format" >/dev/null
  $bodyopt curate import-frame "$data" $frame --mesh "$folder/sculpt.$format" --name sculpt --spread 20 >/dev/null
  $bodyopt curate export-frame "$data" $frame --out "$folder/after.obj" >/dev/null
  moved=$(largest "$folder/before.obj" "$folder/after.obj")
  echo "$format: sculpted by 10 mm, the frame is moved by $moved mm"
  python3 -c "assert abs($moved - 10) < 0.01"
  $bodyopt curate undo "$data" >/dev/null
  $bodyopt curate export-frame "$data" $frame --out "$folder/undone.obj" >/dev/null
  cmp "$folder/before.obj" "$folder/undone.obj"
done

$bodyopt curate redo "$data" >/dev/null
$bodyopt curate add "$data" weight --take rom --frames 40 --set weight=100 >/dev/null
$bodyopt train "$data" --out "$folder/sculpted.safetensors" >/dev/null
for basis in basis sculpted; do
  $bodyopt eval "$folder/$basis.safetensors" --clip "$folder/rom.glb" --frames 40 --device cpu --out "$folder/$basis.pc2"
done
learned=$($bodyopt compare "$folder/basis.pc2" "$folder/sculpted.pc2" --json - | python3 -c 'import json, sys; print(json.load(sys.stdin)["max"])')
echo "trained: $learned mm of 10"
python3 -c "assert $learned > 7"
