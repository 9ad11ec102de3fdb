#!/usr/bin/env bash
# Compares what programs see of libbodyopt.so with tests/library/interface_0.abi, what was last kept (there is no release yet), by libabigail:
# fails at any change but a new function. `abi.sh --keep` makes the file anew.
# Only the functions of bodyopt.h and vulkan.h are compiled, with debug information; the release build has configured.
. "$(dirname "$0")/head.bash"
. scripts/packages.sh
install_packages abigail-tools

kept=tests/library/interface_0.abi
g++ -std=c++20 -g -O0 -fPIC -shared -Wl,-soname,libbodyopt.so.0 -Wl,--version-script=cmake/bodyopt.map \
  -I. -Ibuild/release/generated -DBODYOPT_VERSION='""' runtime/library/*.cpp -o "$folder/libbodyopt.so"
abidw --exported-interfaces-only --headers-dir include/bodyopt --drop-private-types --no-corpus-path --no-show-locs --no-comp-dir-path \
  --out-file "$folder/found.abi" "$folder/libbodyopt.so"
if [ "${1:-}" = --keep ]; then
  mv "$folder/found.abi" "$kept"
  exit
fi
if ! abidiff --no-added-syms "$kept" "$folder/found.abi"; then
  echo "What programs were compiled for has changed. A new field at the end of a structure: keep it (--keep)." >&2
  echo "Anything else breaks them: raise BODYOPT_VERSION_MAJOR" >&2
  exit 1
fi
echo "abi: programs compiled for the last release work"
