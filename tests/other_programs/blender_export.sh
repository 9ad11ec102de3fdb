#!/usr/bin/env bash
# Blender opens what the viewport exports: the motion as glTF and as BVH, whose joints are at the same places, and the
# skin as glTF with morph targets.
. "$(dirname "$0")/blender.bash"
$bodyopt view --headless --do "frame 3; turn elbow 0 0 30; key; frame 20; turn elbow 20 0 -10; key
in 1; out 24; export-clip $folder/posed.glb; export-clip $folder/posed.bvh
export-skin $folder/skin.glb; export-skin $folder/skin.pc2"
in_blender blender_export.py "$folder/posed.glb" "$folder/posed.bvh" 24
in_blender blender_skin.py "$folder/skin.glb" "$folder/skin.pc2" 24

# What `eval` writes of one shot in every format, unit and axis.
/usr/bin/python3 tests/other_programs/paint_character.py rigs/arm/arm.glb "$folder/painted.glb"
$bodyopt train --ddm-only "$folder/painted.glb" --out "$folder/painted.safetensors" >/dev/null
write() { # OUT OPTIONS...
  $bodyopt eval "$folder/painted.safetensors" --clip "$folder/posed.glb" --first-frame 1001 --device cpu --out "$folder/$1" "${@:2}" \
    >/dev/null
}
write a.pc2
write z.pc2 --axis z
write a.mdd
write cm.mdd --axis z --unit-out 0.01
write skin.glb --character "$folder/painted.glb" --rig "$folder/rig.glb"
write rigged.glb --character "$folder/painted.glb" --rigged
in_blender blender_skin.py "$folder/rigged.glb" "$folder/a.pc2" 24
in_blender blender_space.py "$folder/painted.glb" "$folder" 1001 24
