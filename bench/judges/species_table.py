"""python3 species_table.py PROGRAM [--ages 2,10,40,80] [--seasons young,summer,autumn,winter] [--species oak,pine] [--scenes FOLDER]: makes all species of
`coppice tree` at these ages and seasons, and prints height, DBH, leaves, leaf area index with its range, angle of the limbs, flowers, fruit, and
the verdict on the wood. The angle is the median over the laterals of the stem, between their first fifth and the stem; its range is that of
descriptions of open-grown trees (typical values)."""
import argparse
import csv
import json
import math
import pathlib
import subprocess
import tempfile

# Leaf area index and angle of the limbs [degrees], low and high; None: no range.
RANGES = {
    "apple": ((2, 3), (50, 70)),
    "beech": ((4.5, 7.4), (45, 60)),
    "birch": ((2.5, 4), (35, 50)),
    "cherry": ((3, 4), (40, 55)),
    "coconut": (None, None),
    "cypress": ((5, 8), (15, 35)),
    "fern": (None, None),
    "field_maple": ((4, 5), (40, 55)),
    "hawthorn": ((3, 5), (50, 80)),
    "hazel": ((4, 5), (35, 50)),
    "horse_chestnut": ((5, 6), (45, 60)),
    "oak": ((4, 5), (50, 80)),
    "olive": ((1.5, 4), (45, 60)),
    "pine": ((2, 3.5), (60, 90)),
    "poplar": ((4, 6), (15, 25)),
    "spruce": ((6, 10), (50, 110)),
    "willow": ((3, 4), (35, 50)),
}


def read_swc(path):
    rows = [row for row in csv.reader(open(path, encoding="utf-8"), delimiter=" ") if row and not row[0].startswith("#")]
    return {int(r[0]): (tuple(map(float, r[2:5])), float(r[5]), int(r[6])) for r in rows}


def subtract(a, b):
    return tuple(x - y for x, y in zip(a, b))


def measure_angle(nodes):
    """Returns the median angle of the laterals of the stem in degrees; None without any."""
    children = {}
    for n, (_, _, parent) in nodes.items():
        children.setdefault(parent, []).append(n)
    reach = {}
    for n in sorted(nodes, reverse=True):
        position = nodes[n][0]
        reach[n] = max((reach[c] + math.dist(position, nodes[c][0]) for c in children.get(n, [])), default=0)
    stem = [min(n for n, node in nodes.items() if node[2] < 0)]
    while children.get(stem[-1]):
        stem.append(max(children[stem[-1]], key=lambda c: (nodes[c][1], reach[c])))
    angles = []
    for below, fork, above in zip(stem, stem[1:], stem[2:]):
        along = subtract(nodes[above][0], nodes[below][0])
        for lateral in children[fork]:
            if lateral == above:
                continue
            end, goal = lateral, 0.2 * (reach[lateral] + math.dist(nodes[fork][0], nodes[lateral][0]))
            while children.get(end) and math.dist(nodes[fork][0], nodes[end][0]) < goal:
                end = max(children[end], key=lambda c: reach[c])
            out = subtract(nodes[end][0], nodes[fork][0])
            norm = math.hypot(*along) * math.hypot(*out)
            if norm > 0:
                angles.append(math.degrees(math.acos(max(-1, min(1, sum(a * b for a, b in zip(along, out)) / norm)))))
    return sorted(angles)[len(angles) // 2] if angles else None


def mark(value, limits):
    if value is None:
        return "-"
    if limits is None:
        return f"{value:.1f}"
    inside = limits[0] <= value <= limits[1]
    return f"{value:.1f}{'' if inside else '!'} ({limits[0]:g}-{limits[1]:g})"


def make_row(program, folder, species, age, season, scenes):
    tree, report = folder / "tree.swc", folder / "report.json"
    made = subprocess.run(
        [program, "tree", f"{scenes}/{species}.coppice" if scenes else species, "--age", str(age), "--season", season, "--set", "pixels=16", "-o", tree, "--report", report],
        check=True, capture_output=True, text=True)
    counts = json.loads(report.read_text())["counts"]
    index, angles = RANGES[species]
    axes = counts.get("axes", {})
    return [
        species, str(age), season, f"{counts['height']:.2f}", f"{100 * counts['dbh']:.1f}", f"{counts['width']:.1f}", f"{counts['leaves']:,}",
        mark(counts["leaf_area_index"], index if season == "summer" else None), mark(measure_angle(read_swc(tree)), angles),
        f"{counts['flowers']:,}", f"{counts['fruit']:,}", f"{100 * counts['volume']['ratio']:.1f}", str(axes.get("severed", "-")),
        str(counts.get("crossings", "-")), str(made.stderr.count("warning:")),
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--ages", default="2,10,40,80")
    parser.add_argument("--seasons", default="young,summer,autumn,winter")
    parser.add_argument("--species", default=",".join(RANGES))
    parser.add_argument("--scenes", help="folder of scenes in place of those in the program")
    options = parser.parse_args()
    heads = ["species", "age", "season", "height m", "DBH cm", "width m", "leaves", "leaf area index", "angle", "flowers", "fruit", "volume %",
             "severed", "crossings", "warnings"]
    print("| " + " | ".join(heads) + " |\n|" + " --- |" * len(heads))
    with tempfile.TemporaryDirectory() as folder:
        for species in options.species.split(","):
            for age in options.ages.split(","):
                for season in options.seasons.split(","):
                    print("| " + " | ".join(make_row(options.program, pathlib.Path(folder), species, int(age), season, options.scenes)) + " |", flush=True)


if __name__ == "__main__":
    main()
