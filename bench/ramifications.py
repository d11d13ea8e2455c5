#!/usr/bin/env python3
"""ramifications.py COPPICE GEN_TREE [SKELETON...]: what docs/user/comparison.md has beside [Huang2017], as Markdown: furcations and trees of
as many branches as in its tables 1 and 2, a hundred random forks of each kind, and the methods on skeletons. GEN_TREE makes trees
(gen_tree.py SEGMENTS SEED BASENAME). Times are the least of five runs."""
import json
import math
import os
import random
import subprocess
import sys
import tempfile

from judged import mesh_and_check, run

RUNS = 5
PRINTED_FURCATIONS = {4: (1104, 82, 41), 5: (1408, 121, 49), 6: (1904, 179, 76), 7: (2208, 259, 98)}
# branches: segments to ask GEN_TREE for, and the printed times of connection, cut-paste and both subdivisions
PRINTED_TREES = {"1": (85, 1572, 4991, 361 + 3601), "2": (200, 2101, 8486, 547 + 4632), "3": (42, 242, 0, 194 + 414)}
SECOND_SUBDIVISION = ("mesh: topology", "mesh: quads", "mesh: refine")


def write_fork(path, branches, draw):
    """A trunk of radius 0.1 and branches of 0.8 to 1.2 m in random directions, none steeper downward than 12 degrees."""
    rows = ["1 1 0 0 0 0.1 -1", "2 1 0 0 1 0.1 1"]
    for i in range(branches):
        z, a = draw.uniform(-0.2, 1), draw.uniform(0, 2 * math.pi)
        s, l = math.sqrt(1 - z * z), draw.uniform(0.8, 1.2)
        radius = 0.1 / math.sqrt(branches) * draw.uniform(0.7, 1.3)
        rows.append(f"{3 + i} 1 {s * math.cos(a) * l:.5f} {s * math.sin(a) * l:.5f} {1 + z * l:.5f} {radius:.5f} 2")
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(rows) + "\n")


def write_furcation(path, branches):
    """A trunk that goes on, and laterals evenly about it at 60 degrees."""
    rows = ["1 1 0 0 0 0.1 -1", "2 1 0 0 1 0.1 1", "3 1 0 0 2 0.09 2"]
    for i in range(branches - 1):
        a = 2 * math.pi * i / (branches - 1)
        rows.append(f"{4 + i} 1 {0.87 * math.cos(a):.5f} {0.87 * math.sin(a):.5f} 1.5 0.04 2")
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(rows) + "\n")


def timed(coppice, skeleton, folder, *options):
    """The counts of ramifications, and the least seconds of connecting, pasting and both subdivisions."""
    least, counts = {}, None
    for _ in range(RUNS):
        report = os.path.join(folder, "report.json")
        run(coppice, "mesh", skeleton, "-o", os.path.join(folder, "mesh.ply"), "--method", "ramifications", *options, "--report", report)
        with open(report, encoding="utf-8") as file:
            made = json.load(file)
        counts, r = made["counts"], made["counts"]["ramifications"]
        second = sum(s["seconds"] for s in made["stages"] if s["name"] in SECOND_SUBDIVISION)
        now = {"connect": r["connection_seconds"], "paste": r["paste_seconds"], "subdivide": r["subdivision_seconds"] + second}
        least = {k: min(v, least.get(k, v)) for k, v in now.items()}
    return counts, {k: 1000 * v for k, v in least.items()}


def furcations(coppice, folder):
    print("| furcation | row | faces | cut-paste, ms | two subdivisions, ms |\n| --- | --- | --- | --- | --- |")
    path = os.path.join(folder, "furcation.swc")
    for n, (faces, paste, both) in PRINTED_FURCATIONS.items():
        write_furcation(path, n)
        counts, ms = timed(coppice, path, folder, "--all-additional", "--project-method", "none")
        print(f"| {n} | Huang2017 | {faces:,} | {paste} | {both} |")
        print(f"| {n} | ours | {counts['quads']:,} | {ms['paste']:.2f} | {ms['subdivide']:.2f} |", flush=True)


def tree_of(branches, gen_tree, folder):
    """A made-up tree with about as many branches."""
    base = os.path.join(folder, "tree")
    subprocess.run([sys.executable, gen_tree, str(round(2.5 * branches)), "1", base], check=True, capture_output=True)
    return base + ".swc"


def trees(coppice, gen_tree, folder):
    print("\n| tree | row | branches | additional | connection, ms | cut-paste, ms | both subdivisions, ms |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name, (branches, connect, paste, both) in PRINTED_TREES.items():
        additional = {"1": 5, "2": 4, "3": 0}[name]
        print(f"| {name} | Huang2017 | {branches} | {additional} | {connect} | {paste} | {both} |")
        counts, ms = timed(coppice, tree_of(branches, gen_tree, folder), folder, "--project-method", "none")
        r = counts["ramifications"]
        print(f"| {name} | ours | {r['branches']} | {r['additional']} | {ms['connect']:.2f} | {ms['paste']:.2f} | {ms['subdivide']:.2f} |",
              flush=True)


def forks(coppice, folder, count=100):
    print("\n| branches | manifold, one sphere | without crossings | the same with `--all-additional` | `--remesh-rounds 0` | quads, `--remesh-rounds 0` |")
    print("| --- | --- | --- | --- | --- | --- |")
    path, draw = os.path.join(folder, "fork.swc"), random.Random(7)
    ways = (("--method", "ramifications"), ("--method", "ramifications", "--all-additional"),
            ("--method", "ramifications", "--remesh-rounds", "0"), ("--remesh-rounds", "0"))
    for n in range(4, 10):
        sound, clean = 0, [0] * len(ways)
        for _ in range(count):
            write_fork(path, n, draw)
            for i, way in enumerate(ways):
                mesh = os.path.join(folder, "mesh.ply")
                run(coppice, "mesh", path, "-o", mesh, *way)
                judged = json.loads(run(coppice, "check", mesh, "--json"))
                clean[i] += judged["intersections"]["total"] == 0
                if i == 0:
                    sound += judged["sound"] and judged["euler"] == 2 and judged["quads_percent"] == 100
        print(f"| {n} | {sound} | " + " | ".join(str(c) for c in clean) + " |", flush=True)


def skeletons(coppice, paths, folder):
    print("\n| skeleton | method | faces | irregular, % | crossing pairs | radius, mean of absolute | objective before, after | s |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    ways = {"quads": (), "ramifications": ("--method", "ramifications"),
            "ramifications, not optimised": ("--method", "ramifications", "--no-connection-optimisation"),
            "ramifications, all pasted": ("--method", "ramifications", "--all-additional"),
            "ramifications, not projected": ("--method", "ramifications", "--project-method", "none"),
            "cylinders": ("--method", "cylinders")}
    for path in paths:
        for name, way in ways.items():
            judged, counts, _ = mesh_and_check(coppice, path, folder, *way)
            seconds = min(mesh_and_check(coppice, path, folder, *way)[2] for _ in range(2))
            f = counts.get("ramifications")
            objective = f"{f['objective_before']['total']:.1f}, {f['objective_after']['total']:.1f}" if f else "-"
            print(f"| {os.path.basename(path)} | {name} | {judged['faces']:,} | {judged['irregular_percent']:.1f} | "
                  f"{judged['intersections']['total']:,} | {judged['radius_all']['mean_abs']:.4f} | {objective} | {seconds:.3f} |", flush=True)


def main():
    coppice, gen_tree, paths = sys.argv[1], sys.argv[2], sys.argv[3:]
    with tempfile.TemporaryDirectory() as folder:
        furcations(coppice, folder)
        trees(coppice, gen_tree, folder)
        skeletons(coppice, paths, folder)
        forks(coppice, folder)


main()
