#!/usr/bin/env python3
"""Writes the meshes of the scenes in meshes/: dispersion/icosahedron.ply, prism/prism.obj and box/cube.ply.

All of them are computed here from geometry alone; lengths are in scene units, z points up.
"""

import argparse
import math
import pathlib
import struct


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def subtract(a, b):
    return tuple(x - y for x, y in zip(a, b))


def unit(a):
    length = math.sqrt(dot(a, a))
    return tuple(x / length for x in a)


def icosahedron(radius, turn_degrees, gap):
    """An icosahedron that rests on one face, turned about the vertical, `gap` above the floor z = 0."""
    g = (1 + math.sqrt(5)) / 2
    points = [unit(p) for s in (-1, 1) for t in (-g, g) for p in ((0, s, t), (s, t, 0), (t, 0, s))]
    edge2 = min(dot(subtract(p, points[0]), subtract(p, points[0])) for p in points[1:])

    def are_neighbours(i, j):
        d = subtract(points[i], points[j])
        return abs(dot(d, d) - edge2) < 1e-9

    faces = []
    for i in range(12):
        for j in range(i + 1, 12):
            for k in range(j + 1, 12):
                if are_neighbours(i, j) and are_neighbours(j, k) and are_neighbours(i, k):
                    normal = cross(subtract(points[j], points[i]), subtract(points[k], points[i]))
                    faces.append((i, j, k) if dot(normal, points[i]) > 0 else (i, k, j))
    # The axes of a frame whose z axis runs from the face at the bottom through the centre.
    bottom = faces[0]
    up = unit(tuple(-sum(points[v][axis] for v in bottom) for axis in range(3)))
    side = unit(cross(up, points[bottom[0]]))
    front = cross(side, up)
    turn = math.radians(turn_degrees)
    cos, sin = math.cos(turn), math.sin(turn)
    placed = []
    for p in points:
        x, y, z = dot(p, front) * radius, dot(p, side) * radius, dot(p, up) * radius
        placed.append((cos * x - sin * y, sin * x + cos * y, z))
    lowest = min(p[2] for p in placed)
    return [(x, y, z - lowest + gap) for x, y, z in placed], faces


def prism(side, height, gap):
    """A triangular prism, upright: base along x at y = 0, apex at y = side·√3/2; quadrilateral side faces."""
    outline = [(-side / 2, 0.0), (side / 2, 0.0), (0.0, side * math.sqrt(3) / 2)]
    points = [(x, y, gap) for x, y in outline] + [(x, y, gap + height) for x, y in outline]
    faces = [(2, 1, 0), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)]
    return points, faces


def cube():
    """A cube of side 1 that stands on z = 0 around the z axis, as 12 triangles."""
    points = [(x - 0.5, y - 0.5, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)]
    return points, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def ply_header(form, points, faces):
    return (f"ply\nformat {form} 1.0\ncomment written by scripts/make_meshes.py\nelement vertex {len(points)}\n"
            "property float x\nproperty float y\nproperty float z\n"
            f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")


def write_binary_ply(path, points, faces):
    data = ply_header("binary_little_endian", points, faces).encode()
    data += b"".join(struct.pack("<3f", *p) for p in points)
    data += b"".join(struct.pack(f"<B{len(f)}i", len(f), *f) for f in faces)
    path.write_bytes(data)


def write_ascii_ply(path, points, faces):
    lines = [" ".join(f"{x:g}" for x in p) for p in points]
    lines += [" ".join(str(n) for n in (len(f), *f)) for f in faces]
    path.write_text(ply_header("ascii", points, faces) + "\n".join(lines) + "\n")


def write_obj(path, points, faces):
    lines = ["# written by scripts/make_meshes.py"]
    lines += ["v " + " ".join(f"{x:.7f}" for x in p) for p in points]
    lines += ["f " + " ".join(str(v + 1) for v in f) for f in faces]
    path.write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    default = pathlib.Path(__file__).resolve().parent.parent / "meshes"
    parser.add_argument("--folder", type=pathlib.Path, default=default, help="where to write (default: %(default)s)")
    folder = parser.parse_args().folder
    for name in ("dispersion", "prism", "box"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    write_binary_ply(folder / "dispersion" / "icosahedron.ply", *icosahedron(radius=1.1, turn_degrees=37, gap=0.04))
    write_obj(folder / "prism" / "prism.obj", *prism(side=1.2, height=1.2, gap=0.02))
    write_ascii_ply(folder / "box" / "cube.ply", *cube())


if __name__ == "__main__":
    main()
