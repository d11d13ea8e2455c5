#!/usr/bin/env python3
"""clouds.py COPPICE OUT [CLOUD...] [--fork CLOUD] [--poisson PROGRAM]: figure 10 of [Huang2017]: compares point clouds with the surfaces of all methods
on the skeleton from `coppice extract`, and with Poisson reconstruction, as Markdown in OUT/figure10.md. Measures the scan of a synthetic fork, and of
each given cloud its clearest fork and the whole. Points and surfaces are left in OUT/clouds."""
import json
import math
import os
import subprocess

import made_up
from judged import arguments, head, mesh, row, run

SCREENED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "oracles", "screened_poisson.py")
WAYS = {"cylinders": ("--method", "cylinders"), "ramifications": ("--method", "ramifications"), "quads": (),
        "tetrahedra": ("--method", "tetrahedra")}
CUT = 12  # [radii of a fork's node] radius of the ball that is cut out around it


def read_points(coppice, cloud, folder):
    """Returns the coordinates of a cloud in any format."""
    text = os.path.join(folder, "points.xyz")
    run(coppice, "convert", cloud, "-o", text, "--quiet")
    with open(text, encoding="utf-8") as file:
        return [tuple(map(float, line.split()[:3])) for line in file]


def find_nodes(coppice, skeleton, folder):
    """Returns position, radius and parent of every node, parents first."""
    text, nodes = os.path.join(folder, "skeleton.swc"), {}
    run(coppice, "convert", skeleton, "-o", text, "--quiet")
    with open(text, encoding="utf-8") as file:
        for line in file:
            if not line.startswith("#"):
                n, _, x, y, z, radius, parent = line.split()
                nodes[n] = ((float(x), float(y), float(z)), float(radius), parent)
    return nodes


def clearest_fork(nodes):
    """Returns the node with the thickest second child, among children with branches as long as half the radius of the ball."""
    children, reach = {}, dict.fromkeys(nodes, 0)
    for n in reversed(nodes):
        place, _, parent = nodes[n]
        if parent in nodes:
            children.setdefault(parent, []).append(n)
            reach[parent] = max(reach[parent], reach[n] + math.dist(place, nodes[parent][0]))

    def second(n):
        long = [nodes[c][1] for c in children.get(n, []) if reach[c] > CUT / 2 * nodes[n][1]]
        return sorted(long)[-2] if len(long) > 1 else 0

    return max(nodes, key=second)


def around(nodes, fork):
    """Returns the nodes that are connected to the fork within the ball that is cut out, parents first, and all nodes in the ball."""
    middle, radius, _ = nodes[fork]
    inside = {n for n in nodes if math.dist(nodes[n][0], middle) < CUT * radius}
    root = fork
    while nodes[root][2] in inside:
        root = nodes[root][2]
    kept = {root}
    for n in nodes:
        if n in inside and nodes[n][2] in kept:
            kept.add(n)
    return [n for n in nodes if n in kept], inside


def cut_out(coppice, cloud, skeleton, folder, stem):
    """Writes the points and the skeleton around the clearest fork."""
    nodes = find_nodes(coppice, skeleton, folder)
    fork = clearest_fork(nodes)
    kept, inside = around(nodes, fork)
    part, ids = made_up.Swc(), {}
    for n in kept:
        place, radius, parent = nodes[n]
        ids[n] = part.add(place, radius, ids.get(parent, -1))
    with open(stem + ".xyz", "w", encoding="utf-8") as file:
        for point in read_points(coppice, cloud, folder):
            if math.dist(point, nodes[fork][0]) < CUT * nodes[fork][1]:
                if min(inside, key=lambda n: math.dist(point, nodes[n][0])) in ids:
                    file.write("{} {} {}\n".format(*point))
    return stem + ".xyz", part.write(stem + ".swc")


def reconstructions(poisson, cloud, skeleton, stem):
    """Yields name, surface and seconds of the Poisson reconstructions with available programs; normals point away from the axes."""
    if not poisson:
        return
    found = json.loads(run(poisson, cloud, stem + "_poisson.ply", "--axes", skeleton, "--oriented", stem + "_oriented.ply"))
    yield "Poisson", stem + "_poisson.ply", found["normals_seconds"] + found["surface_seconds"]
    done = subprocess.run([SCREENED, stem + "_oriented.ply", stem + "_screened.ply"], capture_output=True, text=True)
    if done.returncode == 0:
        yield "screened Poisson", stem + "_screened.ply", found["normals_seconds"] + float(done.stdout)


def extracted(coppice, cloud, folder, name):
    """Returns the skeleton extracted from a cloud."""
    skeleton = os.path.join(folder, name + ".json")
    run(coppice, "extract", cloud, "-o", skeleton, "--quiet")
    return skeleton


def surfaces(coppice, poisson, cloud, skeleton, stem):
    """Yields every surface of the cloud: its name, file and seconds."""
    for name, way in WAYS.items():
        path = f"{stem}_{name}.ply"
        _, seconds = mesh(coppice, skeleton, path, *way)
        yield name, path, seconds["mesh"]
    yield from reconstructions(poisson, cloud, skeleton, stem)


def millimetres(judged, figure):
    found = judged.get(figure, {})
    return ", ".join(f"{1000 * found[k]:.2f}" for k in ("mean", "p95", "max")) if found.get("n") else "-"


def rows(coppice, poisson, name, cloud, skeleton, stem):
    text = ""
    for way, path, seconds in surfaces(coppice, poisson, cloud, skeleton, stem):
        judged = json.loads(run(coppice, "check", path, "--skeleton", skeleton, "--cloud", cloud, "--json"))
        points = judged["cloud_to_surface_m"]["n"]
        text += row(name, f"{points:,}", way, f"{judged['faces']:,}", "yes" if judged["watertight"] else "no", judged["components"],
                    f"{judged['intersections']['total']:,}",
                    *(millimetres(judged, part + figure) for part in ("", "fork_") for figure in ("cloud_to_surface_m", "surface_to_cloud_m")),
                    f"{judged['surface_bare_percent']:.1f}", f"{seconds:.3f}")
    return text


def scanned_fork(coppice, folder):
    """Returns the scan of a synthetic fork from all sides, and its skeleton. Fine triangles of its field are scanned, so that no method is compared
    with its own surface."""
    surface, cloud = os.path.join(folder, "fork.ply"), os.path.join(folder, "fork_cloud.ply")
    skeleton = made_up.fork().write(os.path.join(folder, "fork.swc"))
    mesh(coppice, skeleton, surface, "--method", "tetrahedra", "--tetra-edge", "0.12")
    run(coppice, "scan", surface, "-o", cloud, "--points", "3000", "--positions", "8", "--distance", "4", "--noise", "0.001", "--quiet")
    return cloud, skeleton


def main():
    args = arguments("Compares point clouds with surfaces, as figure 10 of Huang2017.", "Additional clouds to measure.",
                     {"--poisson": "Path of coppice_poisson, for comparison.", "--fork": "A cloud of which only the fork is measured."})
    coppice, folder = args.coppice, os.path.join(args.out, "clouds")
    os.makedirs(folder, exist_ok=True)
    text = head("cloud", "points", "method", "faces", "closed, manifold", "parts", "crossing pairs", "cloud to surface, mm: mean, p95, max",
                "surface to cloud, mm: mean, p95, max", "at forks: cloud to surface", "at forks: surface to cloud", "bare, %", "s")

    def add(name, cloud, skeleton, stem):
        nonlocal text
        text += rows(coppice, args.poisson, name, cloud, skeleton, os.path.join(folder, stem))

    cloud, skeleton = scanned_fork(coppice, folder)
    add("fork, its own skeleton", cloud, skeleton, "drawn")
    add("fork", cloud, extracted(coppice, cloud, folder, "fork"), "fork")
    for path in args.files + ([args.fork] if args.fork else []):
        name = os.path.splitext(os.path.basename(path))[0]
        skeleton = extracted(coppice, path, folder, name)
        add(name + ", a fork", *cut_out(coppice, path, skeleton, folder, os.path.join(folder, name + "_fork")), name + "_fork")
        if path != args.fork:
            add(name, path, skeleton, name)
    with open(os.path.join(args.out, "figure10.md"), "w", encoding="utf-8") as file:
        file.write(text)


main()
