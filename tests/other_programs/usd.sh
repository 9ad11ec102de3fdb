#!/usr/bin/env bash
# three.js' USDLoader, an independent reader, finds in a .usda that we evaluated the points of the .pc2 of the same frames, the
# texture coordinates of the character's own file, and by UsdSkel the joints of the same rig as glTF, and a bound skin whose blend
# shapes give the same points.
. "$(dirname "$0")/head.bash"
needs node
modules=$PWD/build/npm/node_modules
if [ ! -d "$modules/three" ]; then
  echo "skipped: three.js is not installed (scripts/test --all installs it by npm)"
  exit 0
fi
$bodyopt demo --quick --out "$folder/demo" >/dev/null
cache() { # FRAMES OUT
  $bodyopt eval "$folder/demo/basis.safetensors" --clip "$folder/demo/heldout.glb" --device cpu --frames "$1" --out "$2" >/dev/null
}
cache 1-12 "$folder/shot.pc2"
cache 1-5 "$folder/first.usda"
cache 6-12 "$folder/second.usda"
$bodyopt join "$folder/first.usda" "$folder/second.usda" --out "$folder/shot.usda" >/dev/null
node tests/other_programs/compare_usd.mjs "$modules" "$folder/shot.usda" "$folder/shot.pc2"

/usr/bin/python3 tests/other_programs/paint_character.py rigs/arm/arm.glb "$folder/painted.glb"
$bodyopt train --ddm-only "$folder/painted.glb" --out "$folder/painted.safetensors" >/dev/null
painted() { # OUT OPTIONS...
  $bodyopt eval "$folder/painted.safetensors" --clip "$folder/demo/heldout.glb" --device cpu \
    --frames 1-24 --out "$folder/$1" "${@:2}" >/dev/null
}
painted painted.usda --character "$folder/painted.glb" --rig "$folder/rig.usda"
painted painted.pc2 --rig "$folder/rig.glb"
node tests/other_programs/compare_usd.mjs "$modules" "$folder/painted.usda" "$folder/painted.pc2" textured
painted rigged.usda --character "$folder/painted.glb" --rigged
node tests/other_programs/compare_rigged.mjs "$modules" "$folder/rigged.usda" "$folder/painted.pc2" 24
node tests/other_programs/compare_rig.mjs "$modules" "$folder/rig.usda" "$folder/rig.glb" 24 1 24
