#!/usr/bin/env bash
# Blender plays a cache that we evaluated, on the character that we wrote, and shows the same points.
set -euo pipefail
cd "$(dirname "$0")/../.."
if ! command -v blender >/dev/null; then
  echo "skipped: blender is not installed (scripts/test --all installs it)"
  exit 0
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bodyopt=build/release/bin/bodyopt
$bodyopt demo --quick --out "$folder" >/dev/null
blender --background --factory-startup --python-exit-code 1 --python tests/other_programs/blender_point_cache.py -- \
  "$folder/character.glb" "$folder/heldout.pc2" 5
