#!/usr/bin/env bash
# Blender opens what the viewport exports: the motion as glTF and as BVH, whose joints are at the same places, and the
# skin as glTF with morph targets.
. "$(dirname "$0")/blender.bash"
$bodyopt view --headless --do "frame 3; turn elbow 0 0 30; key; frame 20; turn elbow 20 0 -10; key
in 1; out 24; export-clip $folder/posed.glb; export-clip $folder/posed.bvh
export-skin $folder/skin.glb; export-skin $folder/skin.pc2"
in_blender blender_export.py "$folder/posed.glb" "$folder/posed.bvh" 24
in_blender blender_skin.py "$folder/skin.glb" "$folder/skin.pc2" 24
