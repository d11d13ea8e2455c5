"""Synthetic skeletons for the comparison, as SWC files: replacements for those of the papers, which are not available."""
import math
import os
import random

# One lateral: height on a trunk of 2 m, angle around it in degrees, radius, as in figure 9 of Huang2017.
PASTED = {"a": (1.0, 0, 0.055), "b": (1.2, 25, 0.03), "c": (0.8, 45, 0.08)}


class Swc:
    """Nodes, written in the order they are added."""

    def __init__(self):
        self.rows = []

    def add(self, place, radius, parent=-1):
        self.rows.append((*place, radius, parent))
        return len(self.rows)

    def place(self, node):
        return self.rows[node - 1][:3]

    def radius(self, node):
        return self.rows[node - 1][3]

    def write(self, path):
        with open(path, "w", encoding="utf-8") as file:
            for i, (x, y, z, radius, parent) in enumerate(self.rows, 1):
                file.write(f"{i} 1 {x:.5f} {y:.5f} {z:.5f} {radius:.5f} {parent}\n")
        return path


def scaled(v, s):
    return tuple(s * x for x in v)


def added(*vectors):
    return tuple(map(sum, zip(*vectors)))


def unit(v):
    return scaled(v, 1 / math.hypot(*v))


def across(v):
    """Returns two unit vectors perpendicular to a unit vector and to each other."""
    x, y, z = v
    a = unit((0.0, -z, y) if abs(x) < 0.9 else (z, 0.0, -x))
    return a, (y * a[2] - z * a[1], z * a[0] - x * a[2], x * a[1] - y * a[0])


def straight():
    """A branch of 20 radii."""
    s = Swc()
    s.add((0, 0, 2), 0.1, s.add((0, 0, 0), 0.1))
    return s


def fork():
    """A trunk that forks into two branches, one thinner."""
    s = Swc()
    top = s.add((0, 0, 1), 0.1, s.add((0, 0, 0), 0.1))
    s.add((0, 0.55, 1.8), 0.06, top)
    s.add((0, -0.4, 1.9), 0.075, top)
    return s


def lateral():
    """A thin lateral on a trunk that continues."""
    s = Swc()
    top = s.add((0, 0, 1), 0.1, s.add((0, 0, 0), 0.1))
    s.add((0, 0, 2), 0.095, top)
    s.add((0.7, 0, 1.4), 0.03, top)
    return s


def furcation(branches):
    """A trunk that continues, and evenly distributed laterals at 60 degrees, as in figure 11 of Huang2017."""
    s = Swc()
    top = s.add((0, 0, 1), 0.1, s.add((0, 0, 0), 0.1))
    s.add((0, 0, 2), 0.09, top)
    for i in range(branches - 1):
        a = 2 * math.pi * i / (branches - 1)
        s.add((0.87 * math.cos(a), 0.87 * math.sin(a), 1.5), 0.04, top)
    return s


def neighbours(apart):
    """Three laterals, each at this distance above the previous one and rotated relative to it, as in figure 7 of Huang2017."""
    s = Swc()
    at = s.add((0, 0, 0), 0.1)
    for k in range(3):
        z, a = 0.8 + k * apart, math.radians(35 * k)
        at = s.add((0, 0, z), 0.1, at)
        s.add((0.8 * math.cos(a), 0.8 * math.sin(a), z + 0.1), 0.055, at)
    s.add((0, 0, z + 0.6), 0.09, at)
    return s


def laterals():
    """A trunk of 15 sections with 12 thin laterals, each rotated by the golden angle relative to the previous one."""
    s = Swc()
    at = s.add((0, 0, 0), 0.2)
    for k in range(1, 16):
        z, turn = 0.3 * k, 2.39996 * k
        trunk = at = s.add((0, 0, z), 0.2 - 0.008 * k, at)
        if k < 3 or k > 14:
            continue
        out = (0.25 * math.cos(turn), 0.25 * math.sin(turn), 0.1)
        for i in range(1, 5):
            at = s.add(added((0, 0, z), scaled(out, i)), 0.05 - 0.0075 * i, at)
        at = trunk
    return s


def pasted(height, turn, radius):
    """One lateral on a trunk: see PASTED."""
    s = Swc()
    a = math.radians(turn)
    at = s.add((0, 0, height), 0.1, s.add((0, 0, 0), 0.1))
    s.add((0, 0, 2), 0.1, at)
    s.add((0.8 * math.cos(a), 0.8 * math.sin(a), height + 0.4), radius, at)
    return s


def random_fork(branches, draw):
    """A trunk of radius 0.1 and branches of 0.8 to 1.2 m in random directions, none steeper downward than 12 degrees."""
    s = Swc()
    top = s.add((0, 0, 1), 0.1, s.add((0, 0, 0), 0.1))
    for _ in range(branches):
        z, a = draw.uniform(-0.2, 1), draw.uniform(0, 2 * math.pi)
        h, l = math.sqrt(1 - z * z), draw.uniform(0.8, 1.2)
        radius = 0.1 / math.sqrt(branches) * draw.uniform(0.7, 1.3)
        s.add((h * math.cos(a) * l, h * math.sin(a) * l, 1 + z * l), radius, top)
    return s


def tree(branches, seed):
    """A tree with exactly this number of branches, including the trunk: laterals leave their branch by the golden angle, at 35 to 60 degrees,
    half as long as the rest of the branch above them, and are created breadth first until there are enough."""
    draw, s = random.Random(seed), Swc()
    queue, made = [], 0

    def grow(parent, at, direction, length, radius, nodes, order):
        """Adds one branch of `nodes` nodes after `at`, and queues the positions of possible laterals."""
        nonlocal made
        made += 1
        node = parent
        for k in range(1, nodes + 1):
            bend = 0.0 if order == 0 else 0.10
            direction = unit(added(direction, (draw.gauss(0, 0.07), draw.gauss(0, 0.07), bend + draw.gauss(0, 0.05))))
            at = added(at, scaled(direction, length / nodes))
            thin = radius * (1 - 0.75 * k / nodes)
            node = s.add(at, thin, node)
            if k < nodes and k > (1 if order else nodes // 4):
                queue.append((node, direction, length * (1 - k / nodes), thin, order + 1, 2.4 * k + seed))

    root = s.add((0, 0, 0), 0.12)
    grow(root, (0, 0, 0), (0, 0, 1), 3.2, 0.12, 16, 0)
    taken = 0
    while made < branches:
        node, direction, left, radius, order, turn = queue[taken]
        taken += 1
        a, b = across(direction)
        out = added(scaled(a, math.cos(turn)), scaled(b, math.sin(turn)))
        lean = math.radians(draw.uniform(35, 60))
        start = added(scaled(direction, math.cos(lean)), scaled(out, math.sin(lean)))
        length = max(0.6 * left + 0.2, 6 * radius)
        grow(node, s.place(node), start, length, 0.55 * radius, max(4, round(length / 0.16)), order)
    return s


def trees():
    """Returns trees with the numbers of branches of table 2 of Huang2017: name, branches, skeleton."""
    return [("tree 1", 85, tree(85, 1)), ("tree 2", 200, tree(200, 2)), ("tree 3", 42, tree(42, 3))]


def write_all(folder):
    """Writes all skeletons of the figures, by name."""
    made = {"fork": fork(), "laterals": laterals(), "neighbours": neighbours(0.2), "close_neighbours": neighbours(0.16)}
    made.update({f"pasted_{place}": pasted(*lateral) for place, lateral in PASTED.items()})
    made.update({f"furcation_{n}": furcation(n) for n in range(4, 8)})
    made.update({name.replace(" ", "_"): skeleton for name, _, skeleton in trees()})
    for name, skeleton in made.items():
        skeleton.write(os.path.join(folder, name + ".swc"))
