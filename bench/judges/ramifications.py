#!/usr/bin/env python3
"""ramifications.py COPPICE OUT [SKELETON...] [--small]: the comparison of docs/user/comparison.md with the figures and tables of [Huang2017], as Markdown
in OUT/figure1.md, figure7.md, figure9.md, figure11.md (table 1), figure12.md (table 2), and the variants of the method on the given skeletons and on
a hundred random forks of each kind, variants.md and forks.md. Times are the minimum of five runs. The skeletons of the figures are left in OUT."""
import json
import os
import random
import tempfile

import made_up
from judged import arguments, head, in_turn, mesh_and_check, row, run

RUNS = 5
PRINTED_FURCATIONS = {4: (1104, 82, 41), 5: (1408, 121, 49), 6: (1904, 179, 76), 7: (2208, 259, 98)}
# additional laterals, and the published times of connection, cut-paste and both subdivisions
PRINTED_TREES = {"tree 1": (5, 1572, 4991, 361 + 3601), "tree 2": (4, 2101, 8486, 547 + 4632), "tree 3": (0, 242, 0, 194 + 414)}
SECOND_SUBDIVISION = ("mesh: topology", "mesh: quads", "mesh: refine")
UNITS = ("--method", "ramifications")
AS_PRINTED = (*UNITS, "--project-method", "none")  # the surface of the text: subdivided units
OPTIMISATION = {"optimised": AS_PRINTED, "not optimised": (*AS_PRINTED, "--no-connection-optimisation")}


def stages(counts, seconds):
    """Returns the times of connection, cut-paste and both subdivisions in milliseconds."""
    r = counts["ramifications"]
    second = sum(seconds[s] for s in SECOND_SUBDIVISION)
    return 1000 * r["connection_seconds"], 1000 * r["paste_seconds"], 1000 * (r["subdivision_seconds"] + second)


def timed(coppice, path, folder, way, runs):
    """Returns the report of the check, the counts, and the minimum time of each stage in milliseconds."""
    least = None
    for _ in range(runs):
        judged, counts, seconds = in_turn(coppice, path, folder, {"": way}, 1)[""]
        now = stages(counts, seconds)
        least = now if least is None else tuple(map(min, least, now))
    return judged, counts, least


def watertight(judged):
    return "yes" if judged["watertight"] else "no"


def at_forks(judged):
    return f"{judged['fork_bending']:,.0f}", f"{judged['fork_face_angle_degrees']['p95']:.1f}"


def figure1(coppice, skeletons, folder):
    text = head("skeleton", "method", "closed, manifold", "parts", "handles", "crossing pairs", "forks: bending", "angle between faces, degrees, p95")
    for name, path in skeletons:
        ways = {"generalized cylinders": ("--method", "cylinders"), "ramifications": UNITS, "quads": ()}
        for way, (judged, _, _) in in_turn(coppice, path, folder, ways, 1).items():
            text += row(name, way, watertight(judged), judged["components"], judged["components"] - judged["euler"] // 2, f"{judged['intersections']['total']:,}", *at_forks(judged))
    return text


def figure7(coppice, skeletons, folder):
    text = head("skeleton", "connection", "units", "connections", "pastes", "objective f", "laterals pasted", "crossing pairs",
                "forks: bending", "angle between faces, degrees, p95")
    for name, path in skeletons:
        for way, (judged, counts, _) in in_turn(coppice, path, folder, OPTIMISATION, 1).items():
            r = counts["ramifications"]
            f = r["objective_after"]
            text += row(name, way, *(f"{f[k]:.2f}" for k in ("units", "connections", "pastes", "total")), r["additional"],
                        f"{judged['intersections']['total']:,}", *at_forks(judged))
    return text


def figure9(coppice, folder, out, runs):
    text = head("place", "height, m", "turned by, degrees", "radius over trunk's", "pastes", "cut-paste, ms", "faces", "closed, manifold", "crossing pairs",
                "forks: bending", "angle between faces, degrees, p95")
    for place, (height, turn, radius) in made_up.PASTED.items():
        path = os.path.join(out, f"pasted_{place}.swc")
        judged, counts, ms = timed(coppice, path, folder, (*AS_PRINTED, "--all-additional"), runs)
        text += row(place, height, turn, f"{radius / 0.1:.2f}", f"{counts['ramifications']['objective_after']['pastes']:.2f}", f"{ms[1]:.3f}",
                    f"{judged['faces']:,}", watertight(judged), judged["intersections"]["total"], *at_forks(judged))
    return text


def figure11(coppice, folder, out, runs):
    text = head("furcation", "row", "faces", "cut-paste, ms", "two subdivisions, ms", "closed, manifold", "crossing pairs", "projected: crossing pairs",
                "forks: bending", "angle between faces, degrees, p95")
    for n, (faces, paste, both) in PRINTED_FURCATIONS.items():
        path = os.path.join(out, f"furcation_{n}.swc")
        judged, _, ms = timed(coppice, path, folder, (*AS_PRINTED, "--all-additional"), runs)
        projected, _, _ = mesh_and_check(coppice, path, folder, *UNITS, "--all-additional")
        text += row(n, "Huang2017", f"{faces:,}", paste, both, "yes", "-", "-", "-", "-")
        text += row(n, "ours", f"{judged['faces']:,}", f"{ms[1]:.2f}", f"{ms[2]:.2f}", watertight(judged), judged["intersections"]["total"],
                    projected["intersections"]["total"], *at_forks(projected))
    return text


def figure12(coppice, skeletons, folder, runs):
    text = head("tree", "row", "branches", "additional", "connection, ms", "cut-paste, ms", "both subdivisions, ms", "closed, manifold", "crossing pairs",
                "projected: crossing pairs", "s in all")
    branches = {name: count for name, count, _ in made_up.trees()}
    for name, path in skeletons:
        additional, *printed = PRINTED_TREES[name]
        judged, counts, ms = timed(coppice, path, folder, AS_PRINTED, runs)
        projected, _, seconds = mesh_and_check(coppice, path, folder, *UNITS)
        r = counts["ramifications"]
        text += row(name, "Huang2017", branches[name], additional, *printed, "yes", "-", "-", "-")
        text += row(name, "ours", r["branches"], r["additional"], *(f"{m:.2f}" for m in ms), watertight(judged), f"{judged['intersections']['total']:,}",
                    f"{projected['intersections']['total']:,}", f"{seconds:.3f}")
    return text


def variants(coppice, skeletons, folder):
    text = head("skeleton", "method", "faces", "irregular, %", "crossing pairs", "radius, mean of absolute", "objective before, after", "s")
    ways = {"ramifications": UNITS, "ramifications, not remeshed": (*UNITS, "--remesh-rounds", "0"), "ramifications, not optimised": (*UNITS, "--no-connection-optimisation"),
            "ramifications, all pasted": (*UNITS, "--all-additional"), "ramifications, not projected": AS_PRINTED}
    for name, path in skeletons:
        for way, (judged, counts, seconds) in in_turn(coppice, path, folder, ways, 2).items():
            f = counts["ramifications"]
            text += row(name, way, f"{judged['faces']:,}", f"{judged['irregular_percent']:.1f}", f"{judged['intersections']['total']:,}",
                        f"{judged['radius_all']['mean_abs']:.4f}", f"{f['objective_before']['total']:.1f}, {f['objective_after']['total']:.1f}",
                        f"{seconds['mesh']:.3f}")
    return text


def forks(coppice, folder, count):
    text = head("branches", "closed, manifold", "without handles", "without crossings", "the same with `--all-additional`", "`--remesh-rounds 0`",
                "quads, `--remesh-rounds 0`")
    path, mesh, draw = os.path.join(folder, "fork.swc"), os.path.join(folder, "mesh.ply"), random.Random(7)
    ways = (UNITS, (*UNITS, "--all-additional"), (*UNITS, "--remesh-rounds", "0"), ("--remesh-rounds", "0"))
    for n in range(4, 10):
        closed, spheres, clean = 0, 0, [0] * len(ways)
        for _ in range(count):
            made_up.random_fork(n, draw).write(path)
            for i, way in enumerate(ways):
                run(coppice, "mesh", path, "-o", mesh, *way)
                judged = json.loads(run(coppice, "check", mesh, "--json"))
                clean[i] += judged["intersections"]["total"] == 0
                if i == 0:
                    closed += judged["watertight"] and judged["quads_percent"] == 100
                    spheres += judged["euler"] == 2
        text += row(n, closed, spheres, *clean)
    return text


def main():
    args = arguments("Compares ramifications with the figures and tables of Huang2017.")
    coppice, out = args.coppice, args.out
    made_up.write_all(out)

    def made(*names):
        return [(name, os.path.join(out, name.replace(" ", "_") + ".swc")) for name in names]

    trees = made("tree 3") if args.small else made("tree 1", "tree 2", "tree 3")
    others = [(os.path.basename(path), path) for path in args.files]
    runs, count = (1, 1) if args.small else (RUNS, 100)
    with tempfile.TemporaryDirectory() as folder:
        tables = {"figure1": figure1(coppice, made("fork") + trees, folder), "figure7": figure7(coppice, made("neighbours", "close neighbours") + trees + others, folder),
                  "figure9": figure9(coppice, folder, out, runs),
                  "figure11": figure11(coppice, folder, out, runs),
                  "figure12": figure12(coppice, trees, folder, runs), "variants": variants(coppice, others, folder), "forks": forks(coppice, folder, count)}
    for name, text in tables.items():
        with open(os.path.join(out, name + ".md"), "w", encoding="utf-8") as file:
            file.write(text)


main()
