# Sourced by the checks: goes to the root of the project, makes $folder, which is removed in the end, and names the program
# $bodyopt.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bodyopt=$PWD/build/release/bin/bodyopt

# needs PROGRAM...: leaves, saying so, where one is not installed.
needs() {
  local program
  for program; do
    command -v "$program" >/dev/null && continue
    echo "skipped: $program is not installed (scripts/test --all installs it)"
    exit 0
  done
}
