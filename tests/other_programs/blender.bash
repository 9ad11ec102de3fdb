# Sourced by the checks with Blender: goes to the root of the project, makes $folder, which is removed in the end, and
# names the program $bodyopt. Leaves, saying so, where Blender is not installed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
if ! command -v blender >/dev/null; then
  echo "skipped: blender is not installed (scripts/test --all installs it)"
  exit 0
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bodyopt=build/release/bin/bodyopt

# in_blender SCRIPT ARGUMENTS...: runs a Python script of this folder in Blender; its errors are ours.
in_blender() {
  blender --background --factory-startup --python-exit-code 1 --python "tests/other_programs/$1" -- "${@:2}"
}
