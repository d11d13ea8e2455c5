#!/usr/bin/env python3
"""scans.py COPPICE OUT [--half tuned|held] [--only NAME...] [--jobs N] [extract options...]: compares skeletons of simulated scans with
difficulties (traps) with the trees from which they were created, as Markdown in OUT/scans.md.

Trees are created by `coppice sprout`, scaled to a height and a diameter, and scanned from several positions; occluded points are
missing. Traps are leaves, needles, strays, wires, gaps, a single scanner, two leaders, forks at the ground, leaning stems, understorey,
noise. Every other scan is for tuning (`tuned`), the others are for reports (`held`). Needs numpy and scipy. Columns: diameter at
breast height, height, length and volume relative to the true ones, the intervals of length and volume, warnings, tips found within two spacings and a radius, share of the true axis within a radius
and a spacing of the extracted one, and share of the extracted length that is near no true axis."""
import argparse
import concurrent.futures
import json
import os
import subprocess
import time

import numpy as np
from scipy.spatial import cKDTree

TRAPS = ("bare", "leafy", "conifer", "strays", "strip", "one side", "two leaders", "leaning", "forked at the ground", "understorey", "noise",
         "wire and ground")
BREAST = 1.3


class Tree:
    """Nodes with positions, radii and parents, parents first."""

    def __init__(self, at, radius, parent):
        self.at, self.radius, self.parent = np.asarray(at, float), np.asarray(radius, float), np.asarray(parent, int)

    @staticmethod
    def read(path):
        with open(path, encoding="utf-8") as file:
            rows = [line.split() for line in file if line.strip() and not line.startswith("#")]
        ids = {row[0]: i for i, row in enumerate(rows)}
        return Tree([[float(v) for v in row[2:5]] for row in rows], [float(row[5]) for row in rows],
                    [ids.get(row[6], -1) for row in rows])

    def segments(self):
        child = np.nonzero(self.parent >= 0)[0]
        return child, self.parent[child]

    def starts(self):
        """Returns the start radius of each segment: that of its parent only for the thickest child."""
        child, parent = self.segments()
        thickest = np.zeros(len(self.at))
        np.maximum.at(thickest, parent, self.radius[child])
        return np.where(self.radius[child] >= thickest[parent], self.radius[parent], self.radius[child])

    def length(self):
        child, parent = self.segments()
        return np.linalg.norm(self.at[child] - self.at[parent], axis=1)

    def volume(self):
        child, _ = self.segments()
        a, b = self.starts(), self.radius[child]
        return float((np.pi / 3 * self.length() * (a * a + a * b + b * b)).sum())

    def height(self):
        """Returns the height of the highest point above the lowest root."""
        return float((self.at[:, 2] + self.radius).max() - self.at[self.parent < 0, 2].min())

    def diameter(self):
        """Returns the diameter of the thickest segment at breast height above the lowest root."""
        child, parent = self.segments()
        z = self.at[self.parent < 0, 2].min() + BREAST
        low, high = self.at[parent, 2], self.at[child, 2]
        here = np.nonzero((np.minimum(low, high) <= z) & (np.maximum(low, high) > z))[0]
        if len(here) == 0:
            return 0
        t = (z - low[here]) / np.where(high[here] == low[here], 1, high[here] - low[here])
        return float(2 * ((1 - t) * self.starts()[here] + t * self.radius[child[here]]).max())

    def samples(self, step):
        """Returns positions along the axis with their radii."""
        child, parent = self.segments()
        count = np.maximum(1, np.ceil(self.length() / step).astype(int))
        which = np.repeat(np.arange(len(child)), count)
        first = np.repeat(np.cumsum(count) - count, count)
        t = ((np.arange(len(which)) - first + 0.5) / np.repeat(count, count))[:, None]
        at = (1 - t) * self.at[parent][which] + t * self.at[child][which]
        radius = (1 - t[:, 0]) * self.starts()[which] + t[:, 0] * self.radius[child][which]
        return at, radius

    def tips(self):
        bears = np.zeros(len(self.at), bool)
        bears[self.parent[self.parent >= 0]] = True
        return self.at[~bears]

    def joined(self, other, node):
        """Returns the union with another tree, the root of which becomes this node."""
        parent = np.where(other.parent < 0, node, other.parent + len(self.at))
        return Tree(np.vstack([self.at, other.at - other.at[0] + self.at[node]]), np.concatenate([self.radius, other.radius]),
                    np.concatenate([self.parent, parent]))


def sprout(coppice, folder, random, apical, seasons):
    path = os.path.join(folder, "sprout.swc")
    subprocess.run([coppice, "sprout", "-o", path, "--seed", str(random.integers(1, 10**6)), "--quiet", "--branching-angle",
                    str(random.uniform(30, 65)), "--apical-control", str(apical), "--seasons", str(seasons)], check=True)
    return Tree.read(path)


def scaled(tree, height, diameter):
    at = (tree.at - tree.at[0]) * (height / (tree.at[:, 2].max() - tree.at[0, 2]))
    out = Tree(at, tree.radius, tree.parent)
    out.radius = np.maximum(0.002, out.radius * (diameter / out.diameter()))
    return out


def turned(tree, degrees, about):
    """Returns the tree tilted from the vertical towards an azimuth."""
    a, c, s = np.radians(degrees), np.cos(about), np.sin(about)
    axis = np.array([-s, c, 0])
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return Tree(tree.at @ (np.eye(3) + np.sin(a) * cross + (1 - np.cos(a)) * cross @ cross).T, tree.radius, tree.parent)


def surface(tree, count, random):
    """Returns points evenly distributed over the cones."""
    child, parent = tree.segments()
    a, b, l = tree.starts(), tree.radius[child], tree.length()
    area = l * (a + b)
    which = random.choice(len(child), count, p=area / area.sum())
    t, turn = random.random(count), random.uniform(0, 2 * np.pi, count)
    d = (tree.at[child] - tree.at[parent])[which] / np.maximum(l[which], 1e-9)[:, None]
    u = np.cross(d, np.where(np.abs(d[:, 2:]) < 0.9, [[0.0, 0, 1]], [[1.0, 0, 0]]))
    u /= np.linalg.norm(u, axis=1)[:, None]
    r = ((1 - t) * a[which] + t * b[which])[:, None]
    return tree.at[parent][which] + d * (t * l[which])[:, None] + r * (u * np.cos(turn)[:, None] + np.cross(d, u) * np.sin(turn)[:, None])


def seen(points, scanners, width):
    """Returns whether each point is visible to a scanner: not behind others in a beam with this width at the tree."""
    out = np.zeros(len(points), bool)
    for scanner in scanners:
        v = points - scanner
        far = np.linalg.norm(v, axis=1)
        beam = width / np.median(far)
        key = (np.floor(np.arctan2(v[:, 1], v[:, 0]) / beam).astype(np.int64) << 32) + np.floor(np.arcsin(v[:, 2] / far) / beam).astype(np.int64)
        _, group = np.unique(key, return_inverse=True)
        nearest = np.full(group.max() + 1, np.inf)
        np.minimum.at(nearest, group, far)
        out |= far < nearest[group] + 2 * width
    return out


def thinned(points, edge, random):
    """Returns one point of each voxel."""
    points = points[random.permutation(len(points))]
    _, first = np.unique(np.floor(points / edge).astype(np.int64), axis=0, return_index=True)
    return points[first]


def leaves(tree, random, share, needles):
    """Returns points of leaves around thin branches, or of needles along them."""
    at, radius = tree.samples(0.05)
    thin = at[radius < np.quantile(tree.radius, 0.6)]
    place = thin[random.integers(0, len(thin), share)]
    return place + random.normal(0, 0.02 if needles else 0.05, (share, 3))


def make(coppice, folder, index):
    """Returns the name, the tree, its scan and the point spacing."""
    random, trap = np.random.default_rng(1000 + index), TRAPS[index // 2 % len(TRAPS)]
    diameter = float(np.exp(random.uniform(np.log(0.04), np.log(0.6))))
    height = 1.3 + 1.1 * (100 * diameter) ** 0.75
    seasons, apical = int(random.integers(8, 15)), random.uniform(0.45, 0.6)
    if trap == "conifer":
        apical = random.uniform(0.75, 0.85)
    tree = scaled(sprout(coppice, folder, random, apical, seasons), height, diameter)
    if trap in ("two leaders", "forked at the ground"):
        other = scaled(sprout(coppice, folder, random, apical, seasons), 0.9 * height, 0.85 * diameter)
        z = 0.02 if trap == "forked at the ground" else random.uniform(0.1, 0.2) * height
        on_stem = [0]
        while tree.at[on_stem[-1], 2] < z:
            children = np.nonzero(tree.parent == on_stem[-1])[0]
            on_stem.append(children[np.argmax(tree.radius[children])])
        about = random.uniform(0, 2 * np.pi)
        other = turned(other, 30, about)
        tree = turned(tree.joined(other, on_stem[-1]), -8, about)
        tree.at[:, 2] -= tree.at[0, 2]
    if trap == "leaning":
        tree = turned(tree, random.uniform(12, 25), random.uniform(0, 2 * np.pi))
    area = float((np.pi * tree.length() * (tree.starts() + tree.radius[tree.segments()[0]])).sum())
    spacing = float(max(np.exp(random.uniform(np.log(0.005), np.log(0.04))), np.sqrt(area / 120000)))
    if trap == "noise":
        spacing = max(spacing, 0.03)
    count = int(min(3e6, 4 * area / spacing**2))
    points = surface(tree, count, random)
    if trap in ("leafy", "conifer"):
        points = np.vstack([points, leaves(tree, random, int(0.8 * count), trap == "conifer")])
    if trap in ("understorey", "wire and ground"):
        wide = int(min(4e5, 16 / spacing**2))
        ground = random.uniform(-2, 2, (wide, 3))
        ground[:, 2] = 0.05 * ground[:, 0] + 0.03 * np.sin(3 * ground[:, 1]) + random.normal(0, 0.005, wide)
        points = np.vstack([points, ground])
    if trap == "understorey":
        for _ in range(12):
            where = np.append(random.uniform(-2, 2, 2), 0)
            if np.hypot(*where[:2]) < 0.5:
                continue
            points = np.vstack([points, where + np.abs(random.normal(0, 1, (int(0.02 / spacing**2), 3))) * [0.12, 0.12, 0.35]])
    angles = random.uniform(0, 2 * np.pi) + np.arange(1 if trap == "one side" else 4) * np.pi / 2
    scanners = [np.array([np.cos(a), np.sin(a), 0]) * max(4.0, 0.8 * height) + [0, 0, 1.5] for a in angles]
    points = points[seen(points, scanners, 0.7 * spacing)]
    points += random.normal(0, 0.008 if trap == "noise" else 0.002, points.shape)
    if trap == "strip":
        # Removes a side and a band of the stem, but only the band of the crown: no method could find branches without points.
        z, side = random.uniform(1.6, 3), random.uniform(0, 2 * np.pi)
        beside = points[:, :2] @ [np.cos(side), np.sin(side)]
        gone = (np.abs(points[:, 2] - z) < 0.25) | (beside > 0.3 * diameter) & (beside < diameter) & (points[:, 2] < 0.6 * height)
        points = points[~gone]
    if trap == "strays":
        box = points.min(0), points.max(0)
        points = np.vstack([points, random.uniform(box[0] - 1, box[1] + 1, (len(points) // 150, 3))])
    if trap in ("strays", "wire and ground"):
        t = random.random(int(8 / spacing))[:, None]
        points = np.vstack([points, np.array([-4, 0.3, 0.45 * height]) + t * [8, 0.6, 0.5] + random.normal(0, 0.003, (len(t), 3))])
    return f"{index:02d} {trap}", tree, thinned(points, spacing, random), spacing


def judge(name, truth, found, spacing, seconds):
    at, radius = truth.samples(spacing)
    place, thick = found.samples(spacing)
    near, which = cKDTree(place).query(at)
    back, true = cKDTree(at).query(place)
    tips = truth.tips()
    reach, _ = cKDTree(place).query(tips)
    return {"name": name, "spacing": spacing, "D": truth.diameter(), "diameter": found.diameter() / truth.diameter(),
            "height": found.height() / truth.height(),
            "length": found.length().sum() / truth.length().sum(), "volume": found.volume() / truth.volume(),
            "tips": float((reach < 2 * spacing + radius.min()).mean()), "axis": float((near < radius + spacing).mean()),
            "invented": float((back > radius[true] + 3 * spacing).mean()), "s": seconds}


def measure(coppice, out, index, options):
    folder = os.path.join(out, f"{index:02d}")
    os.makedirs(folder, exist_ok=True)
    name, truth, points, spacing = make(coppice, folder, index)
    cloud, skeleton = os.path.join(folder, "cloud.xyz"), os.path.join(folder, "found.swc")
    np.savetxt(cloud, points, fmt="%.4f")
    begin = time.time()
    report = os.path.join(folder, "report.json")
    done = subprocess.run([coppice, "extract", cloud, "-o", skeleton, "--threads", "1", "--report", report, *options], capture_output=True,
                          text=True, check=False)
    seconds = time.time() - begin
    if done.returncode not in (0, 1):
        return {"name": name, "failed": done.stderr.strip().splitlines()[-1:]}
    row = judge(name, truth, Tree.read(skeleton), spacing, seconds)
    with open(report, encoding="utf-8") as file:
        said = json.load(file)
    trees = said["counts"].get("tree_figures", [])
    for name, unit, true in (("length", "m", truth.length().sum()), ("volume", "m3", truth.volume())):
        row[f"{name}_low"], row[f"{name}_high"] = (sum(tree[f"{name}_{end}_{unit}"] for tree in trees) / true for end in ("low", "high"))
        row[f"{name}_held"] = row[f"{name}_low"] <= 1 <= row[f"{name}_high"]
    tallest = max(trees, key=lambda tree: tree["height_m"])
    row["height_held"] = tallest["height_low_m"] <= truth.height() <= tallest["height_high_m"]
    seen = [tree for tree in trees if tree["dbh_high_m"] > 0]
    row["diameter_held"] = seen[0]["dbh_low_m"] <= truth.diameter() <= seen[0]["dbh_high_m"] if seen else None
    row["marked"] = len(said["warnings"])
    return row


COLUMNS = (("D", "{:.3f}"), ("spacing", "{:.3f}"), ("diameter", "{:.3f}"), ("height", "{:.3f}"), ("length", "{:.2f}"), ("length_low", "{:.2f}"), ("length_high", "{:.2f}"),
           ("volume", "{:.2f}"), ("volume_low", "{:.2f}"), ("volume_high", "{:.2f}"), ("marked", "{:.0f}"), ("tips", "{:.2f}"),
           ("axis", "{:.2f}"), ("invented", "{:.2f}"), ("s", "{:.1f}"))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("coppice")
    parser.add_argument("out")
    parser.add_argument("--half", choices=("tuned", "held"))
    parser.add_argument("--count", type=int, default=48)
    parser.add_argument("--only", nargs="*", type=int)
    parser.add_argument("--jobs", type=int, default=2)
    args, options = parser.parse_known_args()
    wanted = args.only or [i for i in range(args.count) if args.half is None or i % 2 == (args.half == "held")]
    with concurrent.futures.ProcessPoolExecutor(args.jobs) as pool:
        rows = list(pool.map(measure, *zip(*[(os.path.abspath(args.coppice), args.out, i, options) for i in wanted])))
    lines = ["| scan | " + " | ".join(c for c, _ in COLUMNS) + " |", "| --- |" + " --- |" * len(COLUMNS)]
    for row in rows:
        lines.append(f"| {row['name']} | " + (" | ".join(f.format(row[c]) for c, f in COLUMNS) if "D" in row else str(row["failed"])) + " |")
    good = [row for row in rows if "D" in row]
    middle = " | ".join(f.format(np.median([row[c] for row in good])) for c, f in COLUMNS)
    lines.append(f"| median | {middle} |")
    within = {c: np.mean([abs(row[c] - 1) <= limit for row in good]) for c, limit in (("diameter", 0.03), ("length", 0.1), ("volume", 0.15))}
    lines.append("")
    for name in ("height", "length", "volume"):
        lines.append(f"The interval holds the true {name} in {sum(row[name + '_held'] for row in good)} of {len(good)}.")
    with_circle = [row["diameter_held"] for row in good if row["diameter_held"] is not None]
    lines.append(f"That of the diameter of circles holds the true one in {sum(with_circle)} of {len(with_circle)}.")
    lines.append("Share within the goals: " + ", ".join(f"{c} {100 * v:.0f} %" for c, v in within.items()))
    text = "\n".join(lines) + "\n"
    with open(os.path.join(args.out, "scans.md"), "w", encoding="utf-8") as file:
        file.write(text)
    print(text)


if __name__ == "__main__":
    main()
