# Sourced by the checks with Blender.
. "$(dirname "${BASH_SOURCE[0]}")/head.bash"
needs blender

# in_blender SCRIPT ARGUMENTS...: runs a Python script of this folder in Blender; its errors are ours.
in_blender() {
  blender --background --factory-startup --python-exit-code 1 --python "tests/other_programs/$1" -- "${@:2}"
}
