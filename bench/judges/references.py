#!/usr/bin/env python3
"""Extracts skeletons from meshes and scans with an independent model of the same tree, compares them with those models by
`coppice compare`, and prints a Markdown table. Missing files are skipped.

    bench/judges/references.py --data FOLDER [--program build/release/bin/coppice] [--keep FOLDER]

The folder contains tree_mesh, cloud, swc, qsm and mtg with the names listed below.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

# Name, input, model, and who made the model.
PAIRS = [
    ("navis 722817260", "tree_mesh/navis_722817260.ply", "swc/navis_722817260.swc", "skeletor"),
    ("navis 1734350788", "tree_mesh/navis_1734350788.ply", "swc/navis_1734350788.swc", "skeletor"),
    ("modulartree", "tree_mesh/modulartree_small.obj", "swc/modulartree_small.swc", "the generator: exact"),
    ("A3B4", "cloud/plantscan3d_A3B4.asc", "mtg/plantscan3d_A3B4.mtg", "PlantScan3D, by hand"),
    ("rtwig", "qsm/rtwig_cloud.txt", "qsm/rtwig_QSM.mat", "TreeQSM"),
    ("rtwig", "qsm/rtwig_cloud.txt", "qsm/rtwig_QSM.csv", "SimpleForest"),
    ("rtwig", "qsm/rtwig_cloud.txt", "qsm/rtwig_QSM2.csv", "aRchi"),
    ("archi", "qsm/archi_Tree_1_point_cloud.las", "qsm/archi_Tree_1_TreeQSM.txt", "TreeQSM"),
    ("itsme, PLY", "cloud/itsme_pc_tree.ply", "qsm/itsme_tree_1_qsm.mat", "TreeQSM: the stem alone"),
    ("itsme, LAS", "cloud/itsme_pc_tree.las", "qsm/itsme_tree_1_qsm.mat", "TreeQSM: the stem alone"),
    ("itsme, buttresses", "qsm/itsme_buttressed_tree_1_pc.txt", "qsm/itsme_buttressed_tree_1_qsm_1.mat",
     "TreeQSM: leaves in the scan"),
]

HEAD = ["input", "model by", "length: model, m", "found, m", "ratio", "volume: model, m3", "found, m3", "ratio",
        "covered %", "true %", "tips matched", "junctions", "radius error, median %", "model's nodes: median off, m",
        "in radii", "s"]


def mean_point(path):
    """Returns the mean of the rows of a text of coordinates."""
    total, count = [0.0, 0.0, 0.0], 0
    for line in path.read_text().splitlines():
        try:
            point = [float(word) for word in line.split()[:3]]
        except ValueError:
            continue
        if len(point) == 3:
            total = [t + p for t, p in zip(total, point)]
            count += 1
    return [t / count for t in total]


def mtg_to_swc(path, shift, out):
    """Writes the nodes (N) of a multiscale tree graph, FORM-A, as SWC. An entity that begins with ^ continues the last one
    of its column; any other is a child of the last one of the previous column. Nodes without a radius have that of their parent."""
    rows, last, radius_of = [], {}, {0: 0.01}
    names = None
    for line in path.read_text().splitlines():
        cells = line.split("\t")
        if names is None:
            if cells[0] == "ENTITY-CODE":
                names = {name: i for i, name in enumerate(cells) if name}
            continue
        column = next((i for i, cell in enumerate(cells) if cell), None)
        if column is None or not cells[column].endswith("N"):
            continue
        node = len(rows) + 1
        follows = cells[column].startswith("^")
        parent = last.get(column if follows else column - 1, -1)
        last[column] = node
        x, y, z = (float(cells[names[axis]]) + s for axis, s in zip(("XX", "YY", "ZZ"), shift))
        text = cells[names["radius"]].strip() if names["radius"] < len(cells) else ""
        radius_of[node] = float(text) if text else radius_of[max(parent, 0)]
        rows.append(f"{node} 0 {x} {y} {z} {radius_of[node]} {parent}\n")
    out.write_text("".join(rows))


def run(*arguments):
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True)
    if done.returncode not in (0, 1):  # 1: a tree is in doubt, and written
        sys.exit(f"references: {' '.join(map(str, arguments))}: {done.stderr.strip()}")
    return done.stdout


def digits(value, count=3):
    return f"{value:,.0f}" if abs(value) >= 10 ** (count - 1) else f"{value:.{count}g}"


def matches(figures):
    return f"{figures['matched']} of {figures['reference']}, {figures['spurious']} more"


def row(program, folder, name, source, model, maker):
    if model.suffix == ".mtg":
        swc = folder / (model.stem + ".swc")
        mtg_to_swc(model, mean_point(source), swc)
        model = swc
    found, report = folder / (source.stem + ".json"), folder / "report.json"
    run(program, "extract", source, "-o", found, "--quiet", "--report", report)
    seconds = next(s["seconds"] for s in json.loads(report.read_text())["stages"] if s["name"] == "extract")
    c = json.loads(run(program, "compare", model, found, "--json", "--quiet"))
    length, volume = c["length_m"], c["volume_m3"]
    return [name, maker, digits(length["reference"]), digits(length["found"]), f"{length['ratio']:.2f}",
            digits(volume["reference"]), digits(volume["found"]), f"{volume['ratio']:.2f}",
            f"{c['covered_percent']:.1f}", f"{c['true_percent']:.1f}", matches(c["tips"]), matches(c["junctions"]),
            f"{100 * c['radius_error']['p50']:.1f}", digits(c["reference_nodes_m"]["p50"]),
            f"{c['reference_nodes_r']['p50']:.2f}", f"{seconds:.2f}"]


def table(arguments, folder):
    print("| " + " | ".join(HEAD) + " |")
    print("|" + " --- |" * len(HEAD))
    for name, source, model, maker in PAIRS:
        source, model = arguments.data / source, arguments.data / model
        if source.exists() and model.exists():
            print("| " + " | ".join(row(arguments.program, folder, name, source, model, maker)) + " |", flush=True)
        else:
            print(f"references: {source} or {model} is not there", file=sys.stderr)


def main():
    root = pathlib.Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=pathlib.Path, default=root.parent / "shared" / "data")
    parser.add_argument("--program", type=pathlib.Path, default=root / "build" / "release" / "bin" / "coppice")
    parser.add_argument("--keep", type=pathlib.Path, help="Folder for the skeletons; by default they are not kept.")
    arguments = parser.parse_args()
    if arguments.keep:
        arguments.keep.mkdir(parents=True, exist_ok=True)
        table(arguments, arguments.keep)
        return
    with tempfile.TemporaryDirectory() as folder:
        table(arguments, pathlib.Path(folder))


if __name__ == "__main__":
    main()
