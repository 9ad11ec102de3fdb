#!/usr/bin/env bash
# blender_fbx.sh [FILE.fbx ...]: what Blender exports as FBX moves a character as what it exports as glTF does; and the skin
# of each file goes, linearly blended, where Blender's import of it goes.
. "$(dirname "$0")/blender.bash"
in_blender blender_fbx.py rigs/arm/arm.glb "$folder/arm.glb" "$folder/arm.fbx"
$bodyopt train --ddm-only "$folder/arm.glb" --out "$folder/arm.safetensors"
for clip in arm.glb arm.fbx; do
  $bodyopt eval "$folder/arm.safetensors" --clip "$folder/$clip" --device cpu --out "$folder/$clip.pc2"
done
/usr/bin/python3 - "$folder" <<'END'
import struct
import sys

import numpy


def skin(clip):
    with open(f"{sys.argv[1]}/{clip}.pc2", "rb") as file:
        points, _, _, samples = struct.unpack("<iffi", file.read(32)[16:])
        return numpy.frombuffer(file.read(), "<f4").reshape(samples, points, 3)


gltf, fbx = skin("arm.glb"), skin("arm.fbx")
assert gltf.shape == fbx.shape, f"{len(gltf)} frames by glTF, {len(fbx)} by FBX"
moved, apart = abs(gltf - gltf[0]).max(), abs(gltf - fbx).max()
assert moved > 0.05, f"the skin moves by {moved} m only"
assert apart < 1e-4, f"the skins are {apart} m apart"
print(f"{len(gltf)} frames within {apart:.2g} m")
END

# Files with an animation. Without smoothing Direct Delta Mush is linear blending.
for file; do
  rm -f "$folder"/file.*
  in_blender blender_fbx_import.py "$file" "$folder/import.npz" >"$folder/log" || { cat "$folder/log"; exit 1; }
  fps=$(/usr/bin/python3 -c 'import sys, numpy; print(numpy.load(sys.argv[1])["fps"])' "$folder/import.npz")
  $bodyopt train --ddm-only "$file" --unit 1 --smoothing-radius 0.00001 --out "$folder/file.safetensors"
  $bodyopt eval "$folder/file.safetensors" --clip "$file" --unit 1 --fps "$fps" --device cpu --out "$folder/file.pc2"
  /usr/bin/python3 - "$folder" "$file" <<'END'
import sys

import numpy

folder, name = sys.argv[1:]
imported = numpy.load(f"{folder}/import.npz")
with open(f"{folder}/file.pc2", "rb") as file:
    points, samples = numpy.frombuffer(file.read(32)[16:], "<i4")[[0, 3]]
    ours = numpy.frombuffer(file.read(), "<f4").reshape(samples, points, 3)
frames = [k for k in imported["keyed"] if k < samples]
ours, theirs = ours[frames], imported["points"][frames]
# Blender has its meshes in another order: the same point is the one that goes the same way.
ends = [0, len(frames) // 2]
apart = 0
for k in range(points):
    way = abs(theirs[ends] - ours[ends, None, k]).max(axis=(0, 2))
    apart = max(apart, numpy.linalg.norm(theirs[:, way.argmin()] - ours[:, k], axis=1).max())
print(f"{name}: {points} points, {len(frames)} frames within {1000 * apart:.4f} mm")
assert apart < 1e-4, "expected 0.1 mm"
END
done
