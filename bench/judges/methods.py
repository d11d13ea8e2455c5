#!/usr/bin/env python3
"""methods.py COPPICE OUT [SKELETON...] [--small]: compares all methods of `coppice mesh` on synthetic forks and trees and on the given skeletons, and
metaballs with the default, as Markdown in OUT/methods.md and OUT/metaballs.md. Times are the minimum of three alternating runs, for fields of ten, in seconds."""
import os
import tempfile

import made_up
from judged import arguments, head, in_turn, mesh, row

RUNS = 3
FIELD_RUNS = 10
SUMMED = "quads, `--blend 1`"
WAYS = {"quads": (), SUMMED: ("--blend", "1"), "bmesh": ("--method", "bmesh"), "ramifications": ("--method", "ramifications"),
        "tetrahedra": ("--method", "tetrahedra"), "cylinders": ("--method", "cylinders")}
# A single fork has few faces, so edges are half as long.
FINER = {name: way + (("--tetra-edge", "0.25") if name == "tetrahedra" else ("--levels", "3")) for name, way in WAYS.items()}
# Without remeshing, which B-Mesh and Zhu2015 do not have.
FIELDS = {"quads": ("--remesh-rounds", "0"), SUMMED: ("--blend", "1", "--remesh-rounds", "0")}
FIELDS.update({f"bmesh, bulge {b:g}": ("--method", "bmesh", "--ball-bulge", f"{b:g}", "--remesh-rounds", "0") for b in (0.005, 0.02, 0.1, 0.3)})


def methods(coppice, forks, trees, folder, runs):
    text = head("skeleton", "method", "faces", "irregular, %", "crossing pairs", "missing, severed", "radius, mean of absolute: vertices", "faces",
                "forks: bending", "angle between faces, degrees: p50", "p95", "s")
    for name, path, ways in [(*fork, FINER) for fork in forks] + [(*tree, WAYS) for tree in trees]:
        for way, (judged, _, seconds) in in_turn(coppice, path, folder, ways, runs).items():
            angle = judged["fork_face_angle_degrees"]
            text += row(name, way, f"{judged['faces']:,}", f"{judged['irregular_percent']:.1f}", f"{judged['intersections']['total']:,}",
                        f"{judged['segments_missing']}, {judged['axes']['severed']}", f"{judged['radius_all']['mean_abs']:.4f}",
                        f"{judged['radius_areas']['mean_abs']:.4f}", f"{judged['fork_bending']:,.0f}",
                        f"{angle.get('p50', 0):.1f}", f"{angle.get('p95', 0):.1f}", f"{seconds['mesh']:.4f}")
    return text


def radii_along(path, radius, low, high):
    """Returns the minimum and maximum distance of vertices of an OBJ file from the z axis, in radii, between two heights."""
    found = []
    with open(path, encoding="utf-8") as file:
        for line in file:
            if not line.startswith("v "):
                continue
            x, y, z = map(float, line.split()[1:4])
            if low < z < high:
                found.append((x * x + y * y) ** 0.5 / radius)
    return min(found), max(found)


def straight_branch(coppice, folder):
    """Measures the fields on a finely subdivided branch of 20 radii, away from its ends."""
    text = head("field", "balls a radius", "radius, least", "greatest", "spacing allowed, radii", "radius at balls then", "between")
    skeleton, path = made_up.straight().write(os.path.join(folder, "straight.swc")), os.path.join(folder, "straight.obj")
    for way, options in FIELDS.items():
        counts, _ = mesh(coppice, skeleton, path, *options, "--levels", "5")
        balls = counts.get("metaballs")
        chain = [f"{balls[k]:.4f}" for k in ("spacing", "radius_at_balls", "radius_between")] if balls else ["-"] * 3
        least, greatest = radii_along(path, 0.1, 0.5, 1.5)
        text += row(way, f"{balls['balls'] / 22:.1f}" if balls else "-", f"{least:.4f}", f"{greatest:.4f}", *chain)
    return text


def metaballs(coppice, skeletons, folder, runs):
    text = straight_branch(coppice, folder) + "\n"
    text += head("skeleton", "field", "balls", "a segment", "radius, mean of absolute", "p99", "crossing pairs", "field and projection, ms", "times",
                 "whole, ms")
    for name, path in skeletons:
        found = in_turn(coppice, path, folder, FIELDS, runs)
        moving = {way: sum(seconds["mesh: " + s] for s in ("weights", "field", "project")) for way, (_, _, seconds) in found.items()}
        for way, (judged, counts, seconds) in found.items():
            balls = counts.get("metaballs")
            number = (f"{balls['balls']:,}", f"{balls['balls'] / (counts['nodes'] - counts['trees']):.1f}") if balls else ("-", "-")
            text += row(name, way, *number, f"{judged['radius_all']['mean_abs']:.4f}", f"{judged['radius_all']['p99']:.3f}",
                        f"{judged['intersections']['total']:,}", f"{1000 * moving[way]:.2f}", f"{moving[way] / moving[SUMMED]:.2f}",
                        f"{1000 * seconds['mesh']:.2f}")
    return text


def main():
    args = arguments("Compares all methods, and fields of balls and of lines.")
    with tempfile.TemporaryDirectory() as folder:
        def kept(name, skeleton):
            return name, skeleton.write(os.path.join(folder, name.replace(" ", "_") + ".swc"))

        forks = [kept("fork", made_up.fork()), kept("thin lateral", made_up.lateral()), kept("six laterals", made_up.furcation(7))]
        trees = [] if args.small else [kept(name, skeleton) for name, _, skeleton in made_up.trees()]
        others = [(os.path.basename(path), path) for path in args.files]
        field_trees, runs, field_runs = (forks[:1], 1, 1) if args.small else (trees + others[:1], RUNS, FIELD_RUNS)
        tables = {"methods": methods(args.coppice, forks, trees + others, folder, runs),
                  "metaballs": metaballs(args.coppice, field_trees, folder, field_runs)}
        for name, text in tables.items():
            with open(os.path.join(args.out, name + ".md"), "w", encoding="utf-8") as file:
                file.write(text)


main()
