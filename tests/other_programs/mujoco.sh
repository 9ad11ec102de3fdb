#!/usr/bin/env bash
# MuJoCo computes the tendon lengths in tests/data/mujoco_lengths again, which tests compare ours with; with --write they
# are replaced.
set -euo pipefail
cd "$(dirname "$0")/../.."
modules=$PWD/build/npm/node_modules
models=${BODYOPT_SHARED_DATA:-$PWD/../shared/data}/muscles/myo_sim
if ! command -v node >/dev/null || [ ! -d "$modules/@mujoco/mujoco" ]; then
  echo "skipped: MuJoCo is not installed (scripts/test --all installs it by npm)"
  exit 0
fi
if [ ! -d "$models" ]; then
  echo "skipped: MyoSim's models are not in $models"
  exit 0
fi
kept=tests/data/mujoco_lengths
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for model in arm/myoarm leg/myolegs elbow/myoelbow_2dof6muscles; do
  name=$(basename "$model").json
  node tests/other_programs/mujoco_lengths.mjs "$modules" "$models/$model.xml" "$folder/$name"
  if [ "${1:-}" = --write ]; then cp "$folder/$name" "$kept/$name"; fi
  cmp "$folder/$name" "$kept/$name"
done
