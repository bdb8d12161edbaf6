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


def rounded_square(side, radius, count):
    """Points of a square with round corners, at equal steps, and from the middle of a side."""
    straight = side - 2 * radius
    lap = 4 * straight + 2 * math.pi * radius
    points = []
    for i in range(count):
        arc = (i / count * lap + straight / 2) % lap
        quarter, arc = divmod(arc, lap / 4)
        along, turned = min(arc, straight), max(arc - straight, 0) / radius
        x = side / 2 if turned == 0 else side / 2 - radius + radius * math.cos(turned)
        y = -straight / 2 + along + radius * math.sin(turned)
        c, s = ((1, 0), (0, 1), (-1, 0), (0, -1))[int(quarter)]
        points.append((c * x - s * y, s * x + c * y))
    return points


def leaves(radius, wave, number, count):
    """Points of r = radius + wave cos(number angle)."""
    points = []
    for i in range(count):
        angle = 2 * math.pi * i / count
        r = radius + wave * math.cos(number * angle)
        points.append((r * math.cos(angle), r * math.sin(angle)))
    return points


def ridge(points, radius, steps):
    """The lower half of a round wire along a closed line in the xy plane; its lowest line is at z = 0."""
    n = len(points)
    vertices, triangles = [], []
    for i, (x, y) in enumerate(points):
        (x0, y0), (x1, y1) = points[i - 1], points[(i + 1) % n]
        size = math.hypot(x1 - x0, y1 - y0)
        across = ((y1 - y0) / size, (x0 - x1) / size)
        for k in range(steps + 1):
            angle = math.pi * (k / steps - 0.5)
            out, up = radius * math.sin(angle), radius * (1 - math.cos(angle))
            vertices.append((x + out * across[0], y + out * across[1], up))
    for i in range(n):
        j = (i + 1) % n
        for k in range(steps):
            a, b = i * (steps + 1) + k, j * (steps + 1) + k
            triangles += [(a, b, b + 1), (a, b + 1, a + 1)]
    return vertices, triangles


def saddle(radius, half_width, steps):
    """z = (x^2 - y^2) / (2 radius) over a square."""
    vertices, triangles = [], []
    for i in range(steps + 1):
        for j in range(steps + 1):
            x, y = (half_width * (2 * k / steps - 1) for k in (i, j))
            vertices.append((x, y, (x * x - y * y) / (2 * radius)))
    for i in range(steps):
        for j in range(steps):
            a, b = i * (steps + 1) + j, (i + 1) * (steps + 1) + j
            triangles += [(a, b + 1, b), (a, a + 1, b + 1)]
    return vertices, triangles


TOUCH_SHAPES = {  # angles, in degrees, of the small bumps around the middle one; a pair is an arc
    "plain": [],
    "one": [0],
    "opposite": [0, 180],
    "corner": [0, 90],
    "three": [0, 120, 240],
    "four": [0, 90, 180, 270],
    "arc": [(0, 180)],
    "ring": [(0, 360)],
}


def touch_shape(bumps, num_angles=48, num_rings=14):
    """A puck of 28 mm whose underside has the same bump in the middle as all others, and lower ones around it at a radius of 9 mm."""
    radius, thickness, crown = 0.014, 0.008, 0.06
    middle, middle_width, small, small_width, small_radius = 0.003, 0.002, 0.0018, 0.0014, 0.009

    def depth(r, angle):
        """Height of the underside over its lowest point, m."""
        x, y = r * math.cos(angle), r * math.sin(angle)
        rise = middle * math.exp(-((r / middle_width) ** 2) / 2)
        highest = 0.0
        for bump in bumps:
            first, last = bump if isinstance(bump, tuple) else (bump, bump)
            degrees = math.degrees(angle) % 360
            nearest = degrees if first <= degrees <= last else min((first, last), key=lambda end: abs((degrees - end + 180) % 360 - 180))
            bump_x, bump_y = (small_radius * f(math.radians(nearest)) for f in (math.cos, math.sin))
            distance = math.hypot(x - bump_x, y - bump_y)
            highest = max(highest, small * math.exp(-((distance / small_width) ** 2) / 2))
        return middle + r * r / (2 * crown) - rise - highest

    vertices = [(0.0, 0.0, depth(0, 0)), (0.0, 0.0, thickness)]
    for ring in range(1, num_rings + 1):
        r = radius * ring / num_rings
        for k in range(num_angles):
            angle = 2 * math.pi * k / num_angles
            vertices.append((r * math.cos(angle), r * math.sin(angle), depth(r, angle)))
    rim = len(vertices)
    for k in range(num_angles):
        angle = 2 * math.pi * k / num_angles
        vertices.append((radius * math.cos(angle), radius * math.sin(angle), thickness))
    triangles = []
    for k in range(num_angles):
        j = (k + 1) % num_angles
        triangles.append((0, 2 + j, 2 + k))
        for ring in range(num_rings):  # the last step goes up to the rim of the flat top
            a, b = 2 + ring * num_angles, 2 + (ring + 1) * num_angles
            triangles += [(a + k, b + j, b + k), (a + k, a + j, b + j)]
        triangles.append((1, rim + k, rim + j))
    return vertices, triangles


def write_contour(file, description, points):
    lines = [f"# {description}", "# Made by scripts/make_objects.py.", "x_m,y_m,z_m"]
    lines += [f"{round(x, 9) + 0.0:.9f},{round(y, 9) + 0.0:.9f},0" for x, y in points]
    file.write_text("\n".join(lines) + "\n", encoding="ascii")


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
        directory / "roof.obj",
        ["Roof of 12 mm x 12 mm, 24 mm long along x, upside down: its ridge is cut to a face of 3 mm x 24 mm that looks down (-z)."],
        *prism([(-0.0015, -0.006), (0.0015, -0.006), (0.006, 0.006), (-0.006, 0.006)], 0.024),
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

    for name, radius, words, points in (
        ("square", 3, "a square of 120 mm with corners of 30 mm radius", rounded_square(0.12, 0.03, 240)),
        ("clover", 3, "r = 60 mm + 8 mm cos(4 angle)", leaves(0.06, 0.008, 4, 240)),
        ("foil", 3, "r = 60 mm + 14 mm cos(3 angle)", leaves(0.06, 0.014, 3, 240)),
        ("small_square", 2, "a square of 64 mm with corners of 12 mm radius", rounded_square(0.064, 0.012, 160)),
        ("small_clover", 2, "r = 36 mm + 5 mm cos(4 angle)", leaves(0.036, 0.005, 4, 160)),
        ("small_foil", 2, "r = 34 mm + 9 mm cos(3 angle)", leaves(0.034, 0.009, 3, 160)),
    ):
        write_obj(
            directory / f"ridge_{name}.obj",
            [f"Lower half of a round wire, {radius} mm in radius, along a closed line:", f"{words}. The lowest line is at z = 0."],
            *ridge(points, radius * 1e-3, 8),
        )
        write_contour(directory / f"ridge_{name}.csv", f"The lowest line of ridge_{name}.obj: {words}.", points)

    write_obj(
        directory / "saddle.obj",
        ["z = (x^2 - y^2) / (2 * 80 mm) over 100 mm x 100 mm: round along x, hollow along y, as seen from below."],
        *saddle(0.08, 0.05, 50),
    )

    for name, bumps in TOUCH_SHAPES.items():
        write_obj(
            directory / f"touch_{name}.obj",
            ["Puck, 28 mm in diameter, for touch classification: all have the same bump in the middle of the underside (-z).",
             f"Around it, 1.9 mm less deep and at a radius of 9 mm: {name}."],
            *touch_shape(bumps),
        )


if __name__ == "__main__":
    main()
