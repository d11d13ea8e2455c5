#!/usr/bin/env python3
"""polyhedra.py COPPICE OUT SKELETON... [--small]: compares quads, tetrahedra of the octree, the same with the number of triangles of the polyhedron, and
tetrahedra of the polyhedron of Zhu2013, as Markdown in OUT/polyhedra.md. Times are the minimum of three alternating runs in seconds."""
import math
import os
import tempfile

from judged import arguments, head, in_turn, mesh, row

RUNS = 3
OCTREE = ("--method", "tetrahedra")
CUT_THRICE = OCTREE + ("--tetra-levels", "3")  # as for the polyhedron
WAYS = {"quads": (), "octree": OCTREE, "polyhedron": OCTREE + ("--tetra-base", "polyhedron")}
BASE = ("--base", "round")


def as_many(coppice, path, folder):
    """Returns the edge with which the octree has about as many triangles as the polyhedron."""
    out = os.path.join(folder, "count.ply")
    edge = 0.5
    wanted = mesh(coppice, path, out, *WAYS["polyhedron"], *BASE)[0]["triangles"]
    for _ in range(2):
        found = mesh(coppice, path, out, *CUT_THRICE, *BASE, "--tetra-edge", f"{edge:.3f}")[0]["triangles"]
        edge *= math.sqrt(found / wanted)
    return f"{edge:.3f}"


def rows(coppice, path, folder, runs):
    edge = as_many(coppice, path, folder)
    ways = {"quads": WAYS["quads"], "octree": OCTREE, f"octree, `--tetra-edge {edge} --tetra-levels 3`": CUT_THRICE + ("--tetra-edge", edge), "polyhedron": WAYS["polyhedron"]}
    text = ""
    for way, (judged, counts, seconds) in in_turn(coppice, path, folder, {name: way + BASE for name, way in ways.items()}, runs).items():
        tetra = [f"{counts[k]:,}" if k in counts else "-" for k in ("coarse_tetrahedra", "tetrahedra", "samples")]
        squares = counts.get("polyhedron")
        corners = (f"{squares['sections']:,} + {squares['sections_added']:,}, {squares['auxiliary_points']:,}") if squares else "-"
        parts = judged["components"]
        text += row(os.path.basename(path), f"{counts['nodes'] - counts['trees']:,}", way, corners, *tetra, f"{judged['faces']:,}",
                    f"{judged['intersections']['total']:,}", f"{judged['trees']:,}, {parts:,}, {parts - judged['euler'] // 2:,}",
                    f"{judged['segments_missing']}, {judged['axes']['severed']}", f"{judged['radius_all']['mean_abs']:.4f}",
                    f"{judged['volume']['ratio']:.3f}", f"{judged['scaled_jacobian']['p1']:.2f}", f"{seconds['mesh']:.3f}")
    return text


def main():
    args = arguments("Compares tetrahedra of the octree with those of the polyhedron.")
    text = head("skeleton", "segments", "way", "squares + added, auxiliary points", "tetrahedra, coarse", "fine", "vertices", "faces", "crossing pairs",
                "trees, parts, handles", "missing, severed", "radius, mean of absolute", "volume, ratio", "shape, p1", "s")
    with tempfile.TemporaryDirectory() as folder:
        for path in args.files[:1] if args.small else args.files:
            text += rows(args.coppice, path, folder, 1 if args.small else RUNS)
    with open(os.path.join(args.out, "polyhedra.md"), "w", encoding="utf-8") as file:
        file.write(text)


main()
