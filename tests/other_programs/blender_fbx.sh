#!/usr/bin/env bash
# What Blender exports as FBX moves a character as what it exports as glTF does.
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
