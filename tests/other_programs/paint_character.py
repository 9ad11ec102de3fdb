"""paint_character.py IN.glb OUT.glb: gives a character of one primitive texture coordinates (x + 0.5 and y), and the
materials `cloth` below its middle and `skin` above."""
import json
import struct
import sys

import numpy

data = open(sys.argv[1], "rb").read()
length = struct.unpack("<I", data[12:16])[0]
gltf, binary = json.loads(data[20:20 + length]), bytearray(data[28 + length:])
(primitive,) = gltf["meshes"][0]["primitives"]


KINDS = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}


def values(number):
    accessor = gltf["accessors"][number]
    view, width = gltf["bufferViews"][accessor["bufferView"]], int(accessor["type"].replace("SCALAR", "1")[-1])
    begin = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    return numpy.frombuffer(bytes(binary), KINDS[accessor["componentType"]], width * accessor["count"], begin).reshape(-1, width)


def add(array, component, kind):
    array = array.astype(KINDS[component])
    binary.extend(b"\0" * (-len(binary) % 4))
    gltf["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": array.nbytes})
    gltf["accessors"].append({"bufferView": len(gltf["bufferViews"]) - 1, "componentType": component, "type": kind,
                              "count": len(array)})
    if kind == "VEC3":
        gltf["accessors"][-1] |= {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}
    binary.extend(array.tobytes())
    return len(gltf["accessors"]) - 1


attributes = primitive["attributes"]
points, corners = values(attributes["POSITION"]), values(primitive["indices"]).reshape(-1, 3)
attributes["TEXCOORD_0"] = add(points[:, :2] + [0.5, 0], 5126, "VEC2")
above = points[corners].mean(axis=1)[:, 1] > points[:, 1].mean()
gltf["materials"] = [{"name": "cloth"}, {"name": "skin", "pbrMetallicRoughness": {"baseColorFactor": [0.75, 0.5, 0.25, 1]}}]
parts = []
for material, chosen in enumerate((~above, above)):
    used, places = numpy.unique(corners[chosen], return_inverse=True)
    own = {}
    for name, number in attributes.items():
        accessor = gltf["accessors"][number]
        own[name] = add(values(number)[used], accessor["componentType"], accessor["type"])
    parts.append({**primitive, "attributes": own, "indices": add(places.ravel(), 5125, "SCALAR"), "material": material})
gltf["meshes"][0]["primitives"] = parts
gltf["buffers"] = [{"byteLength": len(binary)}]
text = json.dumps(gltf).encode()
text += b" " * (-len(text) % 4)
binary.extend(b"\0" * (-len(binary) % 4))
with open(sys.argv[2], "wb") as file:
    file.write(b"glTF" + struct.pack("<II", 2, 28 + len(text) + len(binary)) + struct.pack("<I", len(text)) + b"JSON" + text
               + struct.pack("<I", len(binary)) + b"BIN\0" + bytes(binary))
