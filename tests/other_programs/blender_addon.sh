#!/usr/bin/env bash
# The add-on, installed from its zip, shows in Blender what `bodyopt eval` writes, refuses what it cannot show, bakes, and
# makes datasets that train as those of files do.
. "$(dirname "$0")/blender.bash"
needs xvfb-run
cmake --build --preset release --target blender_addon >/dev/null
export BLENDER_USER_RESOURCES=$folder/blender

$bodyopt demo --quick --out "$folder" >/dev/null
human=../shared/data/characters/human_muscular.glb
if [ -e "$human" ]; then
  $bodyopt train --ddm-only "$human" --out "$folder/human.safetensors" >/dev/null
  echo '{"schema": "bodyopt-modifiers-1", "modifiers": [{"name": "breath", "type": "breathing"}]}' >"$folder/breath.json"
  $bodyopt modifiers "$folder/human.safetensors" "$folder/breath.json" --out "$folder/alive.safetensors" >/dev/null
  in_blender blender_addon_live.py build/release/bodyopt_blender.zip "$bodyopt" "$folder" "$human" alive.safetensors cmu_01_01
fi
in_blender blender_addon_live.py build/release/bodyopt_blender.zip "$bodyopt" "$folder" "$folder/character.glb" basis.safetensors
in_blender blender_addon_shot.py build/release/bodyopt_blender.zip "$bodyopt" "$folder"
cp "$folder/basis.safetensors" "$folder/dressed.safetensors"
in_blender blender_addon_worn.py build/release/bodyopt_blender.zip "$bodyopt" "$folder"
$bodyopt proxy "$folder/basis.safetensors" --character "$folder/character.glb" --clip "$folder/heldout.glb" \
  --out "$folder/light.safetensors" >/dev/null
in_blender blender_addon_refusals.py build/release/bodyopt_blender.zip "$bodyopt" "$folder"
$bodyopt dynamics "$folder/character.glb" --basis "$folder/basis.safetensors" --jiggle "$folder/jiggle.json" --fps 30 \
  --dynamics-resolution 3000 --out "$folder/soft.safetensors" >/dev/null
in_blender blender_addon_bake.py build/release/bodyopt_blender.zip "$bodyopt" "$folder"
in_blender blender_addon_dataset.py build/release/bodyopt_blender.zip "$bodyopt" "$folder"

# In a window; the browser tells what it is asked to open.
printf '#!/bin/sh\necho "$1" >%s/opened\n' "$folder" >"$folder/browser"
chmod +x "$folder/browser"
BROWSER=$folder/browser xvfb-run -a -s "-screen 0 1280x800x24" blender --factory-startup --window-geometry 0 0 1280 800 \
  --python tests/other_programs/blender_addon_window.py -- build/release/bodyopt_blender.zip "$bodyopt" "$folder"
