#!/usr/bin/env bash
# Blender opens what the viewport exports: the motion as glTF and as BVH, whose joints are at the same places.
set -euo pipefail
cd "$(dirname "$0")/../.."
if ! command -v blender >/dev/null; then
  echo "skipped: blender is not installed (scripts/test --all installs it)"
  exit 0
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
build/release/bin/bodyopt view --headless --do "frame 3; turn elbow 0 0 30; key; frame 20; turn elbow 20 0 -10; key
in 1; out 24; export-clip $folder/posed.glb; export-clip $folder/posed.bvh"
blender --background --factory-startup --python-exit-code 1 --python tests/other_programs/blender_export.py -- \
  "$folder/posed.glb" "$folder/posed.bvh" 24
