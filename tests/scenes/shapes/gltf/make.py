"""Writes the glTF files of this folder. Standard library only: python3 make.py"""

import base64
import json
import math
import struct
import zlib


def png(width, height, pixels):
    """A PNG of RGB or RGBA bytes, `pixels` row by row from the top."""
    kind = {3: 2, 4: 6}[len(pixels[0])]

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    rows = b"".join(
        b"\0" + b"".join(bytes(p) for p in pixels[y * width : (y + 1) * width]) for y in range(height)
    )
    head = struct.pack(">IIBBBBB", width, height, 8, kind, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")


class File:
    """A file in the making: one buffer, and lists of what lies in it."""

    def __init__(self):
        self.bytes = b""
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [],
                     "meshes": [], "accessors": [], "bufferViews": []}

    def add(self, kind, entry):
        self.json.setdefault(kind, []).append(entry)
        return len(self.json[kind]) - 1

    def view(self, data, **more):
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        start = len(self.bytes)
        self.bytes += data
        return self.add("bufferViews", {"buffer": 0, "byteOffset": start, "byteLength": len(data), **more})

    def accessor(self, code, tuples, **more):
        """One accessor with a view of its own; `code` is that of the module struct."""
        width = len(tuples[0])
        component = {"b": 5120, "B": 5121, "h": 5122, "H": 5123, "I": 5125, "f": 5126}[code]
        size = struct.calcsize(code) * width
        stride = size if width == 1 else size + -size % 4
        data = b"".join(struct.pack(f"<{width}{code}", *t).ljust(stride, b"\0") for t in tuples)
        view = self.view(data, **({} if stride == size else {"byteStride": stride}))
        kind = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}[width]
        return self.add("accessors", {"bufferView": view, "componentType": component, "count": len(tuples),
                                      "type": kind, **more})

    def node(self, top=True, **entry):
        node = self.add("nodes", entry)
        if top:
            self.json["scenes"][0]["nodes"].append(node)
        return node

    def texture(self, width, height, pixels, sampler=None):
        view = self.view(png(width, height, pixels))
        image = self.add("images", {"bufferView": view, "mimeType": "image/png"})
        return self.add("textures", {"source": image, **({} if sampler is None else {"sampler": sampler})})

    def glb(self, name):
        self.json["buffers"] = [{"byteLength": len(self.bytes)}]
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        binary = self.bytes + b"\0" * (-len(self.bytes) % 4)
        with open(name, "wb") as out:
            out.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(binary)))
            out.write(struct.pack("<I4s", len(text), b"JSON") + text)
            out.write(struct.pack("<I4s", len(binary), b"BIN\0") + binary)

    def gltf(self, name, binary=None):
        uri = binary and binary.replace(" ", "%20")
        if binary is None:
            uri = "data:application/octet-stream;base64," + base64.b64encode(self.bytes).decode()
        else:
            with open(binary, "wb") as out:
                out.write(self.bytes)
        self.json["buffers"] = [{"byteLength": len(self.bytes), "uri": uri}]
        with open(name, "w") as out:
            json.dump(self.json, out, indent=1)
            out.write("\n")


def quad(file, corner, across, up, turns=1.0, **primitive):
    """A mesh of two triangles, the texture `turns` times along each side."""
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    positions = [tuple(corner[i] + a * across[i] + b * up[i] for i in range(3)) for a, b in corners]
    attributes = {
        "POSITION": file.accessor("f", positions),
        "TEXCOORD_0": file.accessor("f", [(a * turns, (1 - b) * turns) for a, b in corners]),
    }
    indices = file.accessor("B", [(i,) for i in [0, 1, 2, 0, 2, 3]])
    return file.add("meshes", {"primitives": [{"attributes": attributes, "indices": indices, **primitive}]})


def ball(file, around=24, down=12):
    """Attributes and indices of a unit ball."""
    points, uvs, triangles = [], [], []
    for j in range(down + 1):
        for i in range(around + 1):
            a, b = 2 * math.pi * i / around, math.pi * j / down
            points.append((math.sin(b) * math.sin(a), math.cos(b), math.sin(b) * math.cos(a)))
            uvs.append((i / around, j / down))
    for j in range(down):
        for i in range(around):
            a, b = j * (around + 1) + i, (j + 1) * (around + 1) + i
            triangles += ([(a,), (b,), (b + 1,)] if j < down - 1 else []) + ([(a,), (b + 1,), (a + 1,)] if j else [])
    attributes = {
        "POSITION": file.accessor("f", points),
        "NORMAL": file.accessor("b", [tuple(round(127 * x) for x in p) for p in points], normalized=True),
        "TEXCOORD_0": file.accessor("H", [tuple(round(65535 * x) for x in uv) for uv in uvs], normalized=True),
    }
    return {"attributes": attributes, "indices": file.accessor("H", [t for t in triangles])}


def nodes():
    """Nodes below nodes, with matrices and without; strips, fans, a mirror; positions and normals interleaved."""
    file = File()
    corners = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    faces = [(1, 3, 7, 5), (0, 4, 6, 2), (2, 6, 7, 3), (0, 1, 5, 4), (4, 5, 7, 6), (0, 2, 3, 1)]
    normals = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    data = b"".join(
        struct.pack("<6f", *(0.5 * x for x in corners[c]), *n) for f, n in zip(faces, normals) for c in f
    )
    view = file.view(data, byteStride=24)
    position, normal = (
        file.add("accessors", {"bufferView": view, "byteOffset": at, "componentType": 5126, "count": 24, "type": "VEC3"})
        for at in (0, 12)
    )
    indices = file.accessor("H", [(4 * f + c,) for f in range(6) for c in (0, 1, 2, 0, 2, 3)])
    colors = [(0.8, 0.1, 0.1), (0.1, 0.6, 0.2), (0.1, 0.2, 0.8), (0.8, 0.6, 0.1)]
    for color in colors:
        file.add("materials", {"pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": 0}})
    box = file.add("meshes", {"primitives": [
        {"attributes": {"POSITION": position, "NORMAL": normal}, "indices": indices, "material": 0}]})
    # A fan of eight, and a strip that bends.
    fan = [(0, 0, 0)] + [(math.cos(k * math.pi / 4), math.sin(k * math.pi / 4), 0) for k in range(9)]
    fan = file.add("meshes", {"primitives": [
        {"attributes": {"POSITION": file.accessor("f", fan)}, "mode": 6, "material": 1}]})
    strip = [(k / 4, k % 2, (k // 2 % 2) / 4) for k in range(9)]
    strip = file.add("meshes", {"primitives": [
        {"attributes": {"POSITION": file.accessor("f", strip)}, "mode": 5, "material": 2}]})
    # An arrow that shows which way it is mirrored, of positions in 16 bits.
    arrow = [(0, 0, 0), (200, 0, 0), (200, 100, 0), (0, 100, 0), (200, -100, 0), (400, 50, 0), (200, 200, 0)]
    arrow = file.add("meshes", {"primitives": [
        {"attributes": {"POSITION": file.accessor("h", arrow)}, "material": 3,
         "indices": file.accessor("I", [(i,) for i in [0, 1, 2, 0, 2, 3, 4, 5, 6]])}]})
    file.json["extensionsUsed"] = file.json["extensionsRequired"] = ["KHR_mesh_quantization"]
    half = math.sqrt(0.5)
    top = file.node(top=False, mesh=box, translation=[0, 0.75, 0], scale=[0.5, 0.5, 0.5], rotation=[0, half, 0, half])
    leaning = file.node(top=False, mesh=box, children=[top], rotation=[0, 0, math.sin(math.pi / 12), math.cos(math.pi / 12)])
    file.node(children=[leaning], translation=[-1.5, 0, 0])
    file.node(mesh=fan, matrix=[0.7, 0, 0, 0, 0, 0.7, 0, 0, 0, 0, 0.7, 0, 0.3, 0.2, 0, 1])
    file.node(mesh=strip, translation=[-1.2, -1.4, 0.3])
    small = 1 / 400
    file.node(mesh=arrow, translation=[1.3, 0.3, 0], scale=[small] * 3)
    file.node(mesh=arrow, translation=[2.3, -0.7, 0], scale=[-small, small, small])
    file.gltf("nodes.gltf", "nodes 1.bin")


def balls():
    """Balls of many materials that share one list of positions."""
    file = File()
    file.json["extensionsUsed"] = ["KHR_materials_ior"]
    looks = [
        {"pbrMetallicRoughness": {"baseColorFactor": [1, 0.77, 0.34, 1], "metallicFactor": 1, "roughnessFactor": 0.2}},
        {"pbrMetallicRoughness": {"baseColorFactor": [0.6, 0.05, 0.05, 1], "metallicFactor": 0, "roughnessFactor": 0.3}},
        {"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0},
         "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.5},
                        "KHR_materials_volume": {"thicknessFactor": 1, "attenuationColor": [0.5, 0.9, 0.7],
                                                 "attenuationDistance": 1.5}}},
        {"pbrMetallicRoughness": {"baseColorFactor": [0.05, 0.1, 0.5, 1], "metallicFactor": 0, "roughnessFactor": 1},
         "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.05}}},
        {"emissiveFactor": [1, 0.5, 0.1], "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]},
         "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 0.8}}},
        {"pbrMetallicRoughness": {"baseColorFactor": [0.3, 0.7, 0.3, 1]}, "extensions": {"KHR_materials_unlit": {}}},
    ]
    shape = ball(file)
    for i, look in enumerate(looks):
        material = file.add("materials", look)
        mesh = file.add("meshes", {"primitives": [{**shape, "material": material}]})
        file.node(mesh=mesh, translation=[2.2 * (i % 3 - 1), 1.1 - 2.2 * (i // 3), 0])
    file.glb("balls.glb")


def textures():
    """Textures within the file: samplers, channels, relief, a moved one."""
    file = File()
    nearest = file.add("samplers", {"magFilter": 9728, "minFilter": 9728, "wrapS": 33071, "wrapT": 33071})
    mirrored = file.add("samplers", {"wrapS": 33648, "wrapT": 33648})
    # Red at the top left, green, blue at the bottom left, white.
    corners = [(255, 0, 0), (0, 160, 0), (0, 0, 255), (255, 255, 255)]
    checks = file.texture(2, 2, corners, nearest)
    waves = file.texture(2, 2, corners, mirrored)
    # Metal and rough to the right, neither to the left.
    metal = file.texture(2, 1, [(255, 160, 0), (0, 60, 255)], nearest)
    n = 16
    dents = []
    for y in range(n):
        for x in range(n):
            dx, dy = (math.sin(2 * math.pi * (c + 0.5) / n) for c in (x, y))
            dents.append(tuple(round(127.5 + 127.5 * v) for v in (0.4 * dx, 0.4 * dy, math.sqrt(1 - 0.32))))
    dents = file.texture(n, n, dents)
    glow = file.texture(2, 2, [(0, 0, 0), (255, 200, 0), (0, 0, 0), (0, 0, 0)], nearest)
    occlusion = file.texture(2, 1, [(0, 0, 0), (255, 0, 0)], nearest)
    plain = {"metallicFactor": 0, "roughnessFactor": 0.6}
    turned = {"KHR_texture_transform": {"offset": [0.5, 0.0], "rotation": math.pi / 8, "scale": [1.5, 1.5]}}
    looks = [
        ({"pbrMetallicRoughness": {**plain, "baseColorTexture": {"index": checks}}}, 1),
        ({"pbrMetallicRoughness": {**plain, "baseColorTexture": {"index": waves}}}, 3),
        ({"pbrMetallicRoughness": {**plain, "baseColorTexture": {"index": checks, "extensions": turned}}}, 1),
        ({"pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.5, 0.3, 1], "metallicRoughnessTexture": {"index": metal}}}, 1),
        ({"pbrMetallicRoughness": {**plain, "baseColorFactor": [0.6, 0.6, 0.6, 1]},
          "normalTexture": {"index": dents, "scale": 1.5}}, 3),
        ({"pbrMetallicRoughness": {**plain, "baseColorFactor": [0.4, 0.4, 0.6, 1]}, "emissiveFactor": [1, 1, 1],
          "emissiveTexture": {"index": glow}, "occlusionTexture": {"index": occlusion}}, 1),
    ]
    for i, (look, turns) in enumerate(looks):
        material = file.add("materials", look)
        mesh = quad(file, (-1, -1, 0), (2, 0, 0), (0, 2, 0), turns, material=material)
        file.node(mesh=mesh, translation=[2.2 * (i % 3 - 1), 1.1 - 2.2 * (i // 3), 0])
    file.glb("textures.glb")


def alpha():
    """Cut out, half there, and cut out by its factor; a picture beside the file."""
    file = File()
    with open("ring.png", "wb") as out:
        n = 32
        ring = []
        for y in range(n):
            for x in range(n):
                r = math.hypot(x - (n - 1) / 2, y - (n - 1) / 2) / (n / 2)
                solid = min(max(8 * min(r - 0.4, 0.95 - r), 0), 1)
                ring.append((230, 120, 20, round(255 * solid)))
        out.write(png(n, n, ring))
    image = file.add("images", {"uri": "ring.png"})
    ring = file.add("textures", {"source": image})
    pbr = {"metallicFactor": 0, "roughnessFactor": 0.5}
    looks = [
        {"alphaMode": "MASK", "pbrMetallicRoughness": {**pbr, "baseColorTexture": {"index": ring}}},
        {"alphaMode": "BLEND", "pbrMetallicRoughness": {**pbr, "baseColorTexture": {"index": ring}, "baseColorFactor": [1, 1, 1, 0.6]}},
        {"alphaMode": "BLEND", "pbrMetallicRoughness": {**pbr, "baseColorFactor": [0.1, 0.3, 0.9, 0.5]}},
        {"alphaMode": "OPAQUE", "pbrMetallicRoughness": {**pbr, "baseColorTexture": {"index": ring}, "baseColorFactor": [0.3, 1, 1, 0.1]}},
    ]
    for i, look in enumerate(looks):
        mesh = quad(file, (-1, -1, 0), (2, 0, 0), (0, 2, 0), material=file.add("materials", look))
        file.node(mesh=mesh, translation=[1.1 - 2.2 * (i % 2), 1.1 - 2.2 * (i // 2), 0])
    file.gltf("alpha.gltf")


def sparse():
    """A sheet of which a few points are lifted, without a buffer view of its own; two triangles of it share a place."""
    file = File()
    n = 5
    lifted = {1 * n + 1: 0.6, 2 * n + 2: 1.0, 3 * n + 3: 0.6}
    flat = [(i % n - 2, 0, i // n - 2) for i in range(n * n)]
    indices = file.view(struct.pack(f"<{len(lifted)}B", *lifted))
    values = file.view(b"".join(struct.pack("<3f", flat[i][0], h, flat[i][2]) for i, h in lifted.items()))
    positions = file.accessor("f", flat)
    file.json["accessors"][positions]["sparse"] = {
        "count": len(lifted),
        "indices": {"bufferView": indices, "componentType": 5121},
        "values": {"bufferView": values},
    }
    triangles = []
    for j in range(n - 1):
        for i in range(n - 1):
            a = j * n + i
            triangles += [(a,), (a + n,), (a + n + 1,), (a,), (a + n + 1,), (a + 1,)]
    mesh = file.add("meshes", {"primitives": [
        {"attributes": {"POSITION": positions}, "indices": file.accessor("B", triangles)}]})
    file.node(mesh=mesh)
    file.gltf("sparse.gltf")


nodes()
balls()
textures()
alpha()
sparse()
