#!/usr/bin/env python3
"""Grows examples/oak.swc: space colonization in a wide crown [Runions2007], radii by a pipe model.

    python3 examples/grow_oak.py > examples/oak.swc
"""

import math
import random

TRUNK = 1.7  # [m] up to the first branches
STEP = 0.26  # [m]
REACH, KILL = 3.2, 0.6  # [m] distance at which a point attracts a twig, and at which it is removed
TIP_RADIUS, PIPE = 0.02, 2.2  # [m], and the exponent of the pipe model


def crown_points(draw, count):
    """Returns points in a dome, denser near its surface, where leaves are."""
    points = []
    while len(points) < count:
        p = [draw.uniform(-1, 1) for _ in range(3)]
        r = math.hypot(*p)
        if not 0.45 < r < 1 or p[2] < -0.35:
            continue
        points.append((4.0 * p[0], 3.8 * p[1], 4.3 + 3.1 * p[2]))
    return points


def pull(node, points):
    """Returns the unit vector towards the points closest to this node, with noise and a small upward component."""
    total = [0.0, 0.0, 0.12 * len(points)]
    for p in points:
        d = math.dist(p, node) or 1.0
        for k in range(3):
            total[k] += (p[k] - node[k]) / d
    length = math.hypot(*total)
    return [t / length for t in total] if length > 1e-3 else None


def cosine(a, b):
    return sum(x * y for x, y in zip(a, b))


def grow(points):
    nodes, parent, heading = [(0.0, 0.0, 0.0)], [-1], [(0.0, 0.0, 1.0)]

    def add(direction, below):
        # Twigs turn slowly: the direction includes that of the previous segment.
        turned = [0.3 * h + 0.7 * d for h, d in zip(heading[below], direction)]
        length = math.hypot(*turned)
        turned = tuple(t / length for t in turned)
        nodes.append(tuple(c + STEP * t for c, t in zip(nodes[below], turned)))
        parent.append(below)
        heading.append(turned)

    for k in range(round(TRUNK / STEP)):
        add((0.25 * math.sin(0.9 * k), 0.2 * math.cos(1.3 * k), 1.0), len(nodes) - 1)
    grown_from = {}
    for _ in range(60):
        drawn = {}
        for p in points:
            nearest = min(range(len(nodes)), key=lambda i: math.dist(nodes[i], p))
            if math.dist(nodes[nearest], p) < REACH:
                drawn.setdefault(nearest, []).append(p)
        before = len(nodes)
        for i, group in drawn.items():
            direction = pull(nodes[i], group)
            children = grown_from.setdefault(i, [])
            # At most two twigs per node, with an angle of at least about 35 degrees between them.
            if direction is None or len(children) > 1 or any(cosine(direction, c) > 0.8 for c in children):
                continue
            if cosine(direction, heading[i]) < -0.1:
                continue
            children.append(direction)
            add(direction, i)
        points = [p for p in points if all(math.dist(p, n) > KILL for n in nodes[before:])]
        if len(nodes) == before or not points:
            break
    return nodes, parent


def smoothed(nodes, parent):
    """Moves every node between two others halfway to their midpoint, which smooths bends."""
    child = [-1] * len(nodes)
    for i, p in enumerate(parent):
        if p >= 0 and child[p] < 0:
            child[p] = i
    inner = [i for i in range(1, len(nodes)) if child[i] >= 0]
    out = list(nodes)
    for i in inner:
        out[i] = tuple((a + 2 * b + c) / 4 for a, b, c in zip(nodes[parent[i]], nodes[i], nodes[child[i]]))
    return out


def pipe_radii(parent):
    area = [0.0] * len(parent)
    for i in reversed(range(len(parent))):
        # A segment is slightly thicker than the sum of its children, so that unbranched segments taper too.
        area[i] = max(area[i] * 1.03, TIP_RADIUS**PIPE)
        if parent[i] >= 0:
            area[parent[i]] += area[i]
    radius = [a ** (1 / PIPE) for a in area]
    radius[0] *= 1.25  # the base of the trunk
    return radius


def main():
    nodes, parent = grow(crown_points(random.Random(8), 900))
    for _ in range(2):
        nodes = smoothed(nodes, parent)
    radius = pipe_radii(parent)
    print("# id type x y z radius parent: an oak of", len(nodes) - 1, "segments, in metres, made by grow_oak.py")
    for i, (x, y, z) in enumerate(nodes):
        kind = 1 if i == 0 else 3
        print(i + 1, kind, f"{x:.4f} {y:.4f} {z:.4f} {radius[i]:.4f}", parent[i] + 1 if parent[i] >= 0 else -1)


if __name__ == "__main__":
    main()
