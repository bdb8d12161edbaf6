#!/usr/bin/env python3
"""Writes our own test objects into scenes/objects/. Needs the standard library alone; the same bytes on every machine.

Usage: scripts/make_objects.py [DIRECTORY]
"""
import math
import pathlib
import sys


def write_obj(file, description, vertices, triangles):
    lines = [f"# {line}" for line in description] + ["# Made by scripts/make_objects.py. Metres."]
    # Adding 0.0 turns -0 into 0, so that no sign of zero is written.
    lines += ["v " + " ".join(f"{round(c, 9) + 0.0:.9f}" for c in vertex) for vertex in vertices]
    lines += ["f " + " ".join(str(index + 1) for index in triangle) for triangle in triangles]
    file.write_text("\n".join(lines) + "\n", encoding="ascii")


def prism(corners, length):
    """A convex outline in the yz plane, drawn out along x; each end is a fan about its middle."""
    n = len(corners)
    vertices = [(x, y, z) for x in (-length / 2, length / 2) for y, z in corners]
    vertices += [(-length / 2, 0.0, 0.0), (length / 2, 0.0, 0.0)]
    triangles = []
    for i in range(n):
        j = (i + 1) % n
        triangles += [(i, n + i, n + j), (i, n + j, j)]  # side
        triangles += [(2 * n, i, j), (2 * n + 1, n + j, n + i)]  # ends
    return vertices, [tuple(reversed(t)) for t in triangles]


def cross(span, width, length):
    """Two bars across each other in the yz plane, drawn out along x."""
    vertices, triangles = [], []
    for y, z in ((span / 2, width / 2), (width / 2, span / 2)):
        bar_vertices, bar_triangles = prism([(y, -z), (y, z), (-y, z), (-y, -z)], length)
        triangles += [tuple(len(vertices) + i for i in t) for t in bar_triangles]
        vertices += bar_vertices
    return vertices, triangles


def icosphere(levels):
    """Unit sphere of 20 * 4**levels triangles: the icosahedron, each triangle cut into four at its edges' middles."""
    golden = (1 + math.sqrt(5)) / 2
    vertices = []
    for a in (-1, 1):
        for b in (-golden, golden):
            vertices += [(0, a, b), (a, b, 0), (b, 0, a)]
    vertices = [tuple(c / math.hypot(1, golden) for c in v) for v in vertices]
    edge = min(math.dist(vertices[0], v) for v in vertices[1:]) * 1.01
    near = [[math.dist(p, q) < edge for q in vertices] for p in vertices]
    triangles = []
    for i in range(12):
        for j in range(i + 1, 12):
            for k in range(j + 1, 12):
                if near[i][j] and near[j][k] and near[i][k]:
                    p, q, r = vertices[i], vertices[j], vertices[k]
                    outward = sum(
                        p[a] * (q[(a + 1) % 3] * r[(a + 2) % 3] - q[(a + 2) % 3] * r[(a + 1) % 3]) for a in range(3)
                    )
                    triangles.append((i, j, k) if outward > 0 else (i, k, j))
    for _ in range(levels):
        middles = {}

        def middle(i, j):
            key = (min(i, j), max(i, j))
            if key not in middles:
                point = [(a + b) / 2 for a, b in zip(vertices[i], vertices[j])]
                norm = math.hypot(*point)
                middles[key] = len(vertices)
                vertices.append(tuple(c / norm for c in point))
            return middles[key]

        finer = []
        for i, j, k in triangles:
            a, b, c = middle(i, j), middle(j, k), middle(k, i)
            finer += [(i, a, c), (a, j, b), (c, b, k), (a, b, c)]
        triangles = finer
    return vertices, triangles


def knob():
    """Superellipsoid (|y/b|^n + |z/c|^n)^(m/n) + |x/a|^m = 1: the sphere's directions, pushed out or in to that surface."""
    a, b, c = 0.022, 0.010, 0.009
    m, n = 2.5, 1.4
    vertices, triangles = icosphere(4)
    pushed = []
    for direction in vertices:
        x, y, z = (component * half for component, half in zip(direction, (a, b, c)))
        across = abs(y / b) ** n + abs(z / c) ** n
        size = (across ** (m / n) + abs(x / a) ** m) ** (1 / m)
        pushed.append((x / size, y / size, z / size))
    return pushed, triangles


def main():
    directory = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent / "scenes" / "objects")

    apothem = 0.006
    corners = [
        (apothem / math.cos(math.pi / 6) * math.cos(math.pi / 3 * i), apothem / math.cos(math.pi / 6) * math.sin(math.pi / 3 * i))
        for i in range(6)
    ]
    write_obj(
        directory / "hex_prism.obj",
        ["Hexagonal prism, 24 triangles: 12 mm from flat to flat, 60 mm long along x.", "A flat looks down (-z); turned by 30 degrees about x, an edge does."],
        *prism(corners, 0.06),
    )

    half_diagonal = 0.012 / math.sqrt(2)
    diamond = [(half_diagonal, 0.0), (0.0, half_diagonal), (-half_diagonal, 0.0), (0.0, -half_diagonal)]
    write_obj(
        directory / "edge_bar.obj",
        ["Square bar, 12 mm x 12 mm x 60 mm along x, turned so that a straight 90-degree edge looks down (-z)."],
        *prism(diamond, 0.06),
    )

    circumradius = 0.016 / math.sqrt(3)
    triangle = [(circumradius * math.cos(2 * math.pi / 3 * i), circumradius * math.sin(2 * math.pi / 3 * i)) for i in range(3)]
    write_obj(
        directory / "triangular_prism.obj",
        ["Triangular prism: sides of 16 mm, 20 mm long along x."],
        *prism(triangle, 0.02),
    )

    write_obj(
        directory / "cross.obj",
        ["Cross of two bars, 18 mm x 5 mm each, 20 mm long along x; they overlap in the middle."],
        *cross(0.018, 0.005, 0.02),
    )

    write_obj(
        directory / "knob_5k.obj",
        ["Handle, 5120 triangles, 44 mm x 20 mm x 18 mm, with a blunt ridge along x that looks down (-z)."],
        *knob(),
    )


if __name__ == "__main__":
    main()
