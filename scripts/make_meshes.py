#!/usr/bin/env python3
"""Writes the meshes of the scenes in meshes/ that stand in files of their own.

All of them are computed here from geometry alone; lengths are in scene units, z points up. Curved surfaces carry the
normals of the exact surface.
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


def grid_faces(rows, columns, closed_rows):
    """Quadrilaterals between the points of a grid, row by row; columns are joined to a ring, rows if `closed_rows`."""
    faces = []
    for i in range(rows if closed_rows else rows - 1):
        for j in range(columns):
            a, b = i * columns, (i + 1) % rows * columns
            faces.append((a + j, a + (j + 1) % columns, b + (j + 1) % columns, b + j))
    return faces


def torus_knot(turns, waves, ring, wave, tube, rings, sides):
    """A tube of radius `tube` along a knot that runs `turns` times about the z axis at the distance `ring` and `waves`
    times round a circle of radius `wave` there; points, faces and normals."""
    def curve(t):
        r = ring + wave * math.cos(waves * t)
        return (r * math.cos(turns * t), r * math.sin(turns * t), wave * math.sin(waves * t))

    points, normals = [], []
    step = 1e-3
    for i in range(rings):
        t = 2 * math.pi * i / rings
        before, here, after = curve(t - step), curve(t), curve(t + step)
        # Frenet's frame, from differences
        tangent = unit(subtract(after, before))
        binormal = unit(cross(tangent, tuple(a + b - 2 * c for a, b, c in zip(after, before, here))))
        normal = cross(binormal, tangent)
        for j in range(sides):
            angle = 2 * math.pi * j / sides
            out = tuple(math.cos(angle) * n + math.sin(angle) * b for n, b in zip(normal, binormal))
            points.append(tuple(c + tube * o for c, o in zip(here, out)))
            normals.append(out)
    return points, grid_faces(rings, sides, closed_rows=True), normals


def spline(knots, pieces):
    """Points (r, z) and their tangents along the Catmull-Rom spline through `knots`, `pieces` to each piece."""
    ends = [knots[0]] + knots + [knots[-1]]
    samples = []
    for i in range(len(knots) - 1):
        a, b, c, d = ends[i:i + 4]
        for n in range(pieces + (i == len(knots) - 2)):
            t = n / pieces
            samples.append((
                tuple(round(0.5 * (2 * q + t * (r - p + t * (2 * p - 5 * q + 4 * r - s + t * (3 * (q - r) + s - p)))),
                            12)
                      for p, q, r, s in zip(a, b, c, d)),
                tuple(0.5 * (r - p + t * (2 * (2 * p - 5 * q + 4 * r - s) + t * 3 * (3 * (q - r) + s - p)))
                      for p, q, r, s in zip(a, b, c, d))))
    return samples


def arc(centre, radius, start_degrees, end_degrees, pieces):
    """Points (r, z) and tangents along a part of a circle, 0 degrees towards +r and 90 towards +z."""
    samples = []
    for i in range(pieces + 1):
        angle = math.radians(start_degrees + (end_degrees - start_degrees) * i / pieces)
        sign = 1 if end_degrees > start_degrees else -1
        # rounded, so that ends which meet on the axis or each other do so exactly
        cos, sin = math.cos(angle), math.sin(angle)
        samples.append(((round(centre[0] + radius * cos, 12), round(centre[1] + radius * sin, 12)),
                        (-sign * sin, sign * cos)))
    return samples


def revolved(outlines, sides):
    """The surface that outlines of points (r, z) with tangents sweep round the z axis: points, faces and normals, which
    point to the right of each outline's direction. Edges between outlines are sharp; points on the axis are shared."""
    points, faces, normals = [], [], []
    for outline in outlines:
        rows = []
        for (r, z), (dr, dz) in outline:
            nr, nz = unit((dz, -dr, 0.0))[:2]
            row = []
            for j in range(1 if r == 0.0 else sides):
                angle = 2 * math.pi * j / sides
                cos, sin = math.cos(angle), math.sin(angle)
                row.append(len(points))
                points.append((r * cos, r * sin, z))
                normals.append((0.0, 0.0, math.copysign(1.0, nz)) if r == 0.0 else (nr * cos, nr * sin, nz))
            rows.append(row)
        for low, high in zip(rows, rows[1:]):
            for j in range(sides):
                k = (j + 1) % sides
                corners = [low[j % len(low)], low[k % len(low)], high[k % len(high)], high[j % len(high)]]
                faces.append(tuple(dict.fromkeys(corners)))
    return points, faces, normals


def vase():
    """A vase of unit height with a wall, from the middle of its foot outwards, over the lip and down inside."""
    knots = [(0.0, 0.0), (0.12, 0.0), (0.2, 0.012), (0.205, 0.04), (0.17, 0.085), (0.2, 0.15), (0.33, 0.32),
             (0.36, 0.46), (0.29, 0.64), (0.17, 0.78), (0.135, 0.86), (0.16, 0.94), (0.215, 0.99), (0.215, 1.0),
             (0.195, 0.995), (0.135, 0.935), (0.11, 0.86), (0.145, 0.78), (0.26, 0.63), (0.33, 0.46), (0.3, 0.33),
             (0.16, 0.17), (0.08, 0.13), (0.0, 0.125)]
    return revolved([spline(knots, 4)], sides=64)


def lens(aperture, radius, rim):
    """A biconvex lens about the z axis: two caps of spheres of `radius`, and a rim `rim` high of radius `aperture`."""
    half = math.degrees(math.asin(aperture / radius))
    depth = radius * math.cos(math.radians(half))
    return revolved([arc((0.0, depth - rim / 2), radius, -90, -90 + half, 16),
                     [((aperture, -rim / 2), (0.0, 1.0)), ((aperture, rim / 2), (0.0, 1.0))],
                     arc((0.0, rim / 2 - depth), radius, 90 - half, 90, 16)], sides=96)


def ply_header(form, points, faces, normals=()):
    return (f"ply\nformat {form} 1.0\ncomment written by scripts/make_meshes.py\nelement vertex {len(points)}\n"
            "property float x\nproperty float y\nproperty float z\n" +
            ("property float nx\nproperty float ny\nproperty float nz\n" if normals else "") +
            f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")


def write_binary_ply(path, points, faces, normals=()):
    data = ply_header("binary_little_endian", points, faces, normals).encode()
    rows = [p + n for p, n in zip(points, normals)] if normals else points
    data += b"".join(struct.pack(f"<{len(row)}f", *row) for row in rows)
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
    for name in ("dispersion", "prism", "box", "interference", "interference-areas", "antireflection"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    write_binary_ply(folder / "dispersion" / "icosahedron.ply", *icosahedron(radius=1.1, turn_degrees=37, gap=0.04))
    write_obj(folder / "prism" / "prism.obj", *prism(side=1.2, height=1.2, gap=0.02))
    write_ascii_ply(folder / "box" / "cube.ply", *cube())
    write_binary_ply(folder / "interference" / "knot.ply",
                     *torus_knot(turns=2, waves=3, ring=0.62, wave=0.28, tube=0.17, rings=240, sides=24))
    write_binary_ply(folder / "interference" / "vase.ply", *vase())
    write_binary_ply(folder / "interference-areas" / "ring.ply",
                     *revolved([arc((0.5, 0.0), 0.17, -180, 180, 32)], sides=96))
    write_binary_ply(folder / "antireflection" / "lens.ply", *lens(aperture=1.0, radius=4.0, rim=0.08))


if __name__ == "__main__":
    main()
