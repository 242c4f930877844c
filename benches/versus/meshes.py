"""Meshes for the comparisons: made here, or read from OBJ files where there are any; subdivided; written in the
forms that the programs read."""

import math
import os
import struct


def lumpy_ball(cuts):
    """A closed, evenly tessellated surface with bumps, as scans of things have: 20 * 4^cuts triangles."""
    g = (1 + math.sqrt(5)) / 2
    points = []
    for i in range(3):
        for a, b in ((1, g), (-1, g), (1, -g), (-1, -g)):
            p = [0.0, 0.0, 0.0]
            p[(i + 1) % 3], p[(i + 2) % 3] = a, b
            points.append(unit(p))
    near = lambda p, q: sum((x - y) ** 2 for x, y in zip(p, q)) < 1.2
    faces = []
    for a in range(12):
        for b in range(a + 1, 12):
            for c in range(b + 1, 12):
                p, q, r = points[a], points[b], points[c]
                if near(p, q) and near(q, r) and near(r, p):
                    out = dot(cross(sub(q, p), sub(r, p)), p) > 0
                    faces.append((a, b, c) if out else (a, c, b))
    for _ in range(cuts):
        points, faces = at_midpoints(points, faces)
        points = [unit(p) for p in points]
    height = lambda p: (
        1 + 0.12 * math.sin(5 * p[0] + 1) * math.cos(4 * p[1]) + 0.05 * math.sin(17 * p[2]) * math.sin(13 * p[0])
        + 0.01 * math.sin(61 * p[1]) * math.cos(53 * p[2])
    )
    return [[x * height(p) for x in p] for p in points], faces


def hall():
    """A hall of columns under vaults: large walls beside small ornaments, as buildings have."""
    points, faces = [], []

    def grid(rows, columns, at):
        first = len(points)
        for i in range(rows + 1):
            for j in range(columns + 1):
                points.append(at(i / rows, j / columns))
        for i in range(rows):
            for j in range(columns):
                a = first + i * (columns + 1) + j
                b, c, d = a + columns + 1, a + columns + 2, a + 1
                faces.extend([(a, b, c), (a, c, d)])

    def box(x, y, z, w, h, d):
        corner = lambda i: [x + w * (i & 1), y + h * (i >> 1 & 1), z + d * (i >> 2 & 1)]
        first = len(points)
        points.extend(corner(i) for i in range(8))
        for a, b, c, d in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)):
            faces.extend([(first + a, first + b, first + c), (first + a, first + c, first + d)])

    def turned(x, z, profile, sides):
        def at(u, v):
            i = min(int(v * (len(profile) - 1) + 0.5), len(profile) - 1)
            r, y = profile[i]
            a = 2 * math.pi * u
            return [x + r * math.cos(a), y, z + r * math.sin(a)]

        grid(sides, len(profile) - 1, at)

    shaft = [(0.42, 0), (0.42, 0.1), (0.36, 0.15), (0.38, 0.22), (0.3, 0.3)]
    shaft += [(0.3 - 0.05 * i / 8, 0.3 + 2.7 * i / 8) for i in range(1, 9)]
    shaft += [(0.32, 3.05), (0.34, 3.12), (0.3, 3.18), (0.46, 3.3), (0.46, 3.45)]
    box(-10, -0.2, -4, 20, 0.2, 8)
    for z in (-4.2, 4.0):
        box(-10, 0, z, 20, 6, 0.2)
    for x in (-10.2, 10.0):
        box(x, 0, -4, 0.2, 6, 8)
    for row in range(9):
        x = -8.8 + 2.2 * row
        for z in (-2.0, 2.0):
            turned(x, z, shaft, 32)
            box(x - 0.5, 3.45, z - 0.5, 1, 0.15, 1)
            for step in range(3):
                w = 0.62 - 0.08 * step
                box(x - w, 0.05 * step, z - w, 2 * w, 0.05, 2 * w)
        # A vault from column to column.
        grid(24, 6, lambda u, v, x=x: [x - 0.4 + 0.8 * v, 3.6 + 1.6 * math.sin(math.pi * u), -2 * math.cos(math.pi * u)])
    for i in range(60):
        a = 2.39996 * i
        y, r = 0.1 + 0.02 * (i % 5), 0.1 + 0.05 * (i % 7) / 7
        x, z = 8 * math.cos(a) * math.sqrt(i / 60), 3.5 * math.sin(a) * math.sqrt(i / 60)
        turned(x, z, [(r * math.sin(math.pi * k / 8), y + r - r * math.cos(math.pi * k / 8)) for k in range(9)], 12)
    return points, faces


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(dot(a, a))
    return [x / length for x in a]


def edges_cut(faces, count):
    """Each edge's middle as a new vertex number from `count` on, and the faces cut into four."""
    middle, cut = {}, []

    def between(a, b):
        key = (a, b) if a < b else (b, a)
        if key not in middle:
            middle[key] = count + len(middle)
        return middle[key]

    for a, b, c in faces:
        ab, bc, ca = between(a, b), between(b, c), between(c, a)
        cut += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    return middle, cut


def at_midpoints(points, faces):
    """Every triangle cut into four of the same plane."""
    middle, cut = edges_cut(faces, len(points))
    points = points + [[(x + y) / 2 for x, y in zip(points[a], points[b])] for a, b in middle]
    return points, cut


def loop(points, faces):
    """One step of the scheme of Loop ("Smooth Subdivision Surfaces Based on Triangles", 1987), with the weights
    of Warren for the vertices; borders are curves of their own."""
    middle, cut = edges_cut(faces, len(points))
    opposite = {key: [] for key in middle}
    around = [set() for _ in points]
    for face in faces:
        for k in range(3):
            a, b, c = face[k], face[(k + 1) % 3], face[(k + 2) % 3]
            opposite[(a, b) if a < b else (b, a)].append(c)
            around[a].update((b, c))
    border = [[] for _ in points]
    new = []
    for (a, b), others in opposite.items():
        p, q = points[a], points[b]
        if len(others) == 2:
            r, s = points[others[0]], points[others[1]]
            new.append([0.375 * (p[k] + q[k]) + 0.125 * (r[k] + s[k]) for k in range(3)])
        else:
            new.append([0.5 * (p[k] + q[k]) for k in range(3)])
            border[a].append(b)
            border[b].append(a)
    moved = []
    for i, p in enumerate(points):
        if border[i]:
            ring, weight = border[i], 0.125
            if len(ring) != 2:
                moved.append(p)
                continue
        else:
            ring = around[i]
            weight = 3 / 16 if len(ring) == 3 else 3 / (8 * len(ring)) if ring else 0
        rest = 1 - weight * len(ring)
        moved.append([rest * p[k] + weight * sum(points[j][k] for j in ring) for k in range(3)])
    return moved + new, cut


def read_obj(path):
    points, faces = [], []
    with open(path, errors="replace") as lines:
        for line in lines:
            word = line.split()
            if not word:
                continue
            if word[0] == "v":
                points.append([float(x) for x in word[1:4]])
            elif word[0] == "f":
                corners = [int(w.split("/")[0]) for w in word[1:]]
                corners = [c - 1 if c > 0 else len(points) + c for c in corners]
                for k in range(1, len(corners) - 1):
                    face = (corners[0], corners[k], corners[k + 1])
                    if len(set(face)) == 3:
                        faces.append(face)
    return points, faces


def bounds(points, faces):
    used = [points[i] for face in faces for i in face]
    low = [min(p[k] for p in used) for k in range(3)]
    high = [max(p[k] for p in used) for k in range(3)]
    return low, high


def view(points, faces, inside):
    """Eye, target, up, vertical angle in degrees and light, for a thing seen from outside or a room from inside."""
    low, high = bounds(points, faces)
    size = sub(high, low)
    if inside:
        at = lambda *f: [low[k] + size[k] * f[k] for k in range(3)]
        return [*at(0.2, 0.4, 0.5), *at(0.8, 0.4, 0.5), 0, 1, 0, 60, *at(0.5, 0.9, 0.5)]
    center = [(low[k] + high[k]) / 2 for k in range(3)]
    r = math.sqrt(dot(size, size)) / 2
    eye = [center[k] + r * 2.6 * (0.45, 0.35, 0.82)[k] for k in range(3)]
    light = [center[k] + r * (2.0, 3.0, 1.5)[k] for k in range(3)]
    return [*eye, *center, 0, 1, 0, 36, *light]


def with_ground(points, faces):
    """A square below, for rays to hit that miss the thing itself."""
    low, high = bounds(points, faces)
    size = sub(high, low)
    r = math.sqrt(dot(size, size)) / 2
    x, z, y = (low[0] + high[0]) / 2, (low[2] + high[2]) / 2, low[1] - 0.002 * r
    n, g = len(points), 6 * r
    corners = [[x - g, y, z - g], [x + g, y, z - g], [x + g, y, z + g], [x - g, y, z + g]]
    return points + corners, faces + [(n, n + 2, n + 1), (n, n + 3, n + 2)]


def write_mesh(path, points, faces, seen):
    """`RTSM`, counts of vertices and triangles, sixteen f32 of view, then f32 vertices and u32 corners."""
    flat = [x for p in points for x in p]
    corners = [i for f in faces for i in f]
    with open(path + ".part", "wb") as out:
        out.write(b"RTSM" + struct.pack("<II", len(points), len(faces)))
        out.write(struct.pack("<16f", *seen, *[0] * (16 - len(seen))))
        out.write(struct.pack(f"<{len(flat)}f", *flat))
        out.write(struct.pack(f"<{len(corners)}I", *corners))
    os.rename(path + ".part", path)


def normals(points, faces):
    """Normals at the vertices, weighted by area."""
    sums = [[0.0, 0.0, 0.0] for _ in points]
    for a, b, c in faces:
        n = cross(sub(points[b], points[a]), sub(points[c], points[a]))
        for i in (a, b, c):
            for k in range(3):
                sums[i][k] += n[k]
    return [unit(n) if dot(n, n) > 0 else [0.0, 1.0, 0.0] for n in sums]


def write_obj(path, points, faces):
    with open(path, "w") as out:
        out.writelines("v %.7g %.7g %.7g\n" % tuple(p) for p in points)
        out.writelines("vn %.5f %.5f %.5f\n" % tuple(n) for n in normals(points, faces))
        out.writelines("f %d//%d %d//%d %d//%d\n" % tuple(i + 1 for i in f for _ in "vn") for f in faces)


def write_pov(path, points, faces):
    with open(path, "w") as out:
        out.write("#declare Model = mesh2 { vertex_vectors { %d" % len(points))
        out.writelines(",\n<%.7g,%.7g,%.7g>" % tuple(p) for p in points)
        out.write("\n} normal_vectors { %d" % len(points))
        out.writelines(",\n<%.5f,%.5f,%.5f>" % tuple(n) for n in normals(points, faces))
        out.write("\n} face_indices { %d" % len(faces))
        out.writelines(",\n<%d,%d,%d>" % f for f in faces)
        out.write("\n} }\n")
