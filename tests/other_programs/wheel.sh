#!/usr/bin/env bash
# The wheel, installed in a fresh environment: its module gives the skin of `bodyopt eval`, its verbs run with progress, are
# cancelled and refuse as the program does, and it needs no library that this machine was given for the build, nor Netgen.
. "$(dirname "$0")/head.bash"
needs patchelf
cmake --build --preset release --target wheel >/dev/null
/usr/bin/python3 -m venv --system-site-packages "$folder/fresh"  # for NumPy
"$folder/fresh/bin/pip" install --quiet --no-index --no-deps build/release/bodyopt-*.whl
installed=$("$folder/fresh/bin/python" -c 'import bodyopt, pathlib; print(pathlib.Path(bodyopt.__file__).parent)')
case $installed in "$folder"/*) ;; *) echo "imported from $installed"; exit 1 ;; esac
netgen=$installed/program/lib/netgen
taken=$(LD_LIBRARY_PATH=$installed ldd "$installed/program/bin/bodyopt" "$installed"/*.so* "$netgen"/*.so* | awk -v own="$installed" \
  '$2 == "=>" && index($3, own) != 1 {print $1}' | sort -u)
for library in $taken; do
  case $library in
    libc.* | libm.* | libdl.* | librt.* | libpthread.* | libgcc_s.* | libstdc++.* | libz.*) ;;
    libX11.* | libxcb.* | libXau.* | libXdmcp.* | libbsd.* | libmd.*) ;;  # of any desktop
    *) echo "$library is not in the wheel"; exit 1 ;;
  esac
done
# As on a machine without Netgen's own package.
hidden=$(dirname "$(sed -n 's/^NGLIB:FILEPATH=//p' build/release/CMakeCache.txt)")
cd "$folder"
unshare --map-root-user --mount sh -c 'mount -t tmpfs none "$0" && exec "$@"' "$hidden" \
  env -i PATH="$folder/fresh/bin:/usr/bin:/bin" HOME="$folder" python "$OLDPWD/tests/other_programs/wheel.py"
"$folder/fresh/bin/bodyopt" info demo/basis.safetensors >/dev/null
