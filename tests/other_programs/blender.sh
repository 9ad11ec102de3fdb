#!/usr/bin/env bash
# Blender plays a cache that we evaluated, on the character that we wrote, and shows the same points.
. "$(dirname "$0")/blender.bash"
$bodyopt demo --quick --out "$folder" >/dev/null
in_blender blender_point_cache.py "$folder/character.glb" "$folder/heldout.pc2" 5
