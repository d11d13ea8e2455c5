#!/usr/bin/env python3
"""Generates examples/lsystem.swc: the monopodial tree of Honda as an L-system [Prusinkiewicz1990, page 56], with
laterals that are much thinner than their parent branches.

    python3 examples/grow_lsystem.py > examples/lsystem.swc

    w:  A(l, r)
    A(l, r) -> F(l, r) [ pitch(45) B(0.6 l, 0.3 r) ] roll(137.5) A(0.9 l, 0.8 r)
    B(l, r) -> F(l, r) [ yaw(-45) level C(0.6 l, 0.55 r) ] C(0.9 l, 0.8 r)
    C(l, r) -> F(l, r) [ yaw(+45) level B(0.6 l, 0.55 r) ] B(0.9 l, 0.8 r)
"""

import math

STEPS = 9
TRUNK, RADIUS = 1.0, 0.25  # [m] of the first segment


def turned(v, axis, degrees):
    """Returns v rotated about a unit axis."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    along = sum(a * b for a, b in zip(v, axis)) * (1 - c)
    across = (axis[1] * v[2] - axis[2] * v[1], axis[2] * v[0] - axis[0] * v[2], axis[0] * v[1] - axis[1] * v[0])
    return tuple(c * x + s * y + along * a for x, y, a in zip(v, across, axis))


def unit(v):
    length = math.hypot(*v)
    return tuple(x / length for x in v)


class Turtle:
    """Turtle with heading h, left l and up u, as in the book."""

    def __init__(self, at, node, h, l, u):
        self.at, self.node, self.h, self.l, self.u = at, node, h, l, u

    def copy(self):
        return Turtle(self.at, self.node, self.h, self.l, self.u)

    def roll(self, degrees):
        self.l, self.u = (turned(v, self.h, degrees) for v in (self.l, self.u))

    def pitch(self, degrees):
        self.h, self.u = (turned(v, self.l, degrees) for v in (self.h, self.u))

    def yaw(self, degrees):
        self.h, self.l = (turned(v, self.u, degrees) for v in (self.h, self.l))

    def level(self):
        """Rolls the turtle until left is horizontal."""
        across = (-self.h[1], self.h[0], 0.0)
        if math.hypot(*across) < 1e-6:
            return
        self.l = unit(across)
        self.u = tuple(self.h[i - 2] * self.l[i - 1] - self.h[i - 1] * self.l[i - 2] for i in range(3))


def grow(kind, length, radius, steps, turtle, nodes):
    if steps == 0:
        return
    turtle.at = tuple(a + length * h for a, h in zip(turtle.at, turtle.h))
    nodes.append((turtle.at, radius, turtle.node))
    turtle.node = len(nodes) - 1
    side = turtle.copy()
    if kind == "A":
        side.pitch(45)
        grow("B", 0.6 * length, 0.3 * radius, steps - 1, side, nodes)
        turtle.roll(137.5)
        grow("A", 0.9 * length, 0.8 * radius, steps - 1, turtle, nodes)
        return
    other = "C" if kind == "B" else "B"
    side.yaw(-45 if kind == "B" else 45)
    side.level()
    grow(other, 0.6 * length, 0.55 * radius, steps - 1, side, nodes)
    grow(other, 0.9 * length, 0.8 * radius, steps - 1, turtle, nodes)


def main():
    nodes = [((0.0, 0.0, 0.0), 1.2 * RADIUS, -1)]
    start = Turtle(nodes[0][0], 0, (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    grow("A", TRUNK, RADIUS, STEPS, start, nodes)
    print("# id type x y z radius parent: an L-system of", len(nodes) - 1, "segments, in metres, made by grow_lsystem.py")
    for i, ((x, y, z), radius, parent) in enumerate(nodes):
        kind = 1 if i == 0 else 3
        print(i + 1, kind, f"{x:.4f} {y:.4f} {z:.4f} {radius:.5f}", parent + 1 if parent >= 0 else -1)


if __name__ == "__main__":
    main()
