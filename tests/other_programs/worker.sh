#!/usr/bin/env bash
# The program as the nodes of a farm have it: built without the viewport neither it nor its packages need GLFW or X11. It
# evaluates, and says what 'view' lacks.
. "$(dirname "$0")/head.bash"

# On a system without any package.
touch "$folder/status"
. scripts/packages.sh
installed=$(apt-get -s install --no-install-recommends -o Dir::State::status="$folder/status" "${worker_packages[@]}" | sed -n 's/^Inst //p')
if [ -z "$installed" ] || grep '^\(libx11\|libxcb\|libgl1\)' <<<"$installed"; then
  echo "worker: its packages bring X11 or GL along, or cannot be found" >&2
  exit 1
fi
echo "worker: its packages are $(wc -l <<<"$installed"), with all that they depend on"

cmake --preset worker >"$folder/configured"
cmake --build --preset worker
cmake --install build/worker --component program --prefix "$folder/prefix" >>"$folder/configured"
worker=$folder/prefix/bin/bodyopt
if ldd "$worker" | grep -i 'glfw\|X11\|imgui'; then
  echo "worker: it is linked with what only the viewport needs" >&2
  exit 1
fi
"$worker" demo --quick --out "$folder/demo" >/dev/null
"$worker" eval "$folder/demo/basis.safetensors" --clip "$folder/demo/heldout.glb" --frames 1-3 --device cpu --out "$folder/a.pc2" >/dev/null
"$bodyopt" eval "$folder/demo/basis.safetensors" --clip "$folder/demo/heldout.glb" --frames 1-3 --device cpu --out "$folder/b.pc2" >/dev/null
cmp "$folder/a.pc2" "$folder/b.pc2"
if said=$("$worker" view 2>&1) || ! grep -q BODYOPT_BUILD_VIEWER=ON <<<"$said"; then
  echo "worker: 'view' does not say what is missing: $said" >&2
  exit 1
fi
echo "worker: the program without the viewport evaluates the same bits"
