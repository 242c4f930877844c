#!/usr/bin/env python3
"""Writes the files beside it: a wavy disk of colored vertices as PLY, and two leaves as glTF with COLOR_0."""

import base64
import json
import math
import struct
from pathlib import Path

HERE = Path(__file__).parent
RINGS, SPOKES = 4, 16

points, colors = [(0.0, 0.2, 0.0)], [(255, 255, 255)]
for ring in range(1, RINGS + 1):
    for spoke in range(SPOKES):
        a = 2 * math.pi * spoke / SPOKES
        r = ring / RINGS
        points.append((r * math.cos(a), 0.2 * math.cos(3 * a) * r * r, r * math.sin(a)))
        hue = [max(0, min(1, abs((6 * spoke / SPOKES + k) % 6 - 3) - 1)) for k in (0, 4, 2)]
        colors.append(tuple(round(255 * (1 - r + r * h)) for h in hue))
faces = []
for spoke in range(SPOKES):
    next = (spoke + 1) % SPOKES
    faces.append((0, 1 + next, 1 + spoke))
    for ring in range(1, RINGS):
        a, b = 1 + (ring - 1) * SPOKES, 1 + ring * SPOKES
        faces.append((a + spoke, a + next, b + next, b + spoke))

head = f"""ply
format binary_little_endian 1.0
comment as Blender and MeshLab write it
element vertex {len(points)}
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
property uchar alpha
element face {len(faces)}
property list uchar int vertex_indices
end_header
"""
body = b"".join(struct.pack("<3f4B", *p, *c, 255) for p, c in zip(points, colors))
body += b"".join(struct.pack(f"<B{len(f)}i", len(f), *f) for f in faces)
(HERE / "wheel.ply").write_bytes(head.encode() + body)

quad = struct.pack("<12f", -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0)
floats = struct.pack("<12f", 1, 0.1, 0.1, 0.1, 1, 0.1, 0.1, 0.1, 1, 1, 1, 1)
shorts = struct.pack("<16H", *[65535, 0, 0, 65535, 65535, 65535, 0, 65535, 0, 65535, 65535, 65535, 0, 0, 0, 65535])
indices = struct.pack("<6H", 0, 1, 2, 0, 2, 3)
data = quad + floats + shorts + indices
views, at = [], 0
for part in (quad, floats, shorts, indices):
    views.append({"buffer": 0, "byteOffset": at, "byteLength": len(part)})
    at += len(part)


def primitive(color, material):
    attributes = {"POSITION": 0} | ({} if color is None else {"COLOR_0": color})
    return {"attributes": attributes, "indices": 3, "material": material}


def plain(factor):
    return {"pbrMetallicRoughness": {"baseColorFactor": factor, "metallicFactor": 0}, "extensions": {"KHR_materials_ior": {"ior": 1}}}


file = {
    "asset": {"version": "2.0"},
    "nodes": [{"mesh": i, "translation": [2.4 * (i - 1), 0, 0], "rotation": [0, 0.1, 0, 0.995]} for i in range(3)],
    "meshes": [{"primitives": [primitive(*p)]} for p in ((1, 0), (2, 1), (None, 1))],
    "materials": [plain([1, 1, 1, 1]), plain([1, 0.6, 0.3, 1])],
    "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
        {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"},
        {"bufferView": 2, "componentType": 5123, "normalized": True, "count": 4, "type": "VEC4"},
        {"bufferView": 3, "componentType": 5123, "count": 6, "type": "SCALAR"},
    ],
    "bufferViews": views,
    "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
}
(HERE / "leaves.gltf").write_text(json.dumps(file, indent=1) + "\n")
