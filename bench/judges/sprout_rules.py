#!/usr/bin/env python3
"""Measures whether sprouted trees satisfy their rules: python3 bench/judges/sprout_rules.py COPPICE

Prints the tables of docs/user/growing.md: angles and turns of laterals, leaders by apical control, two adjacent trees,
shaded branches, and times. All results are read from the skeletons that the program writes."""

import json
import math
import os
import subprocess
import sys
import tempfile

STRAIGHT = "--stem-tropism 0 --branch-tropism 0 --light-turn 0 --wobble 0 --shade 0 --seasons 10"


def sprout(program, options):
    """Returns positions, parents and the report of trees with these options."""
    with tempfile.TemporaryDirectory() as folder:
        tree, path = os.path.join(folder, "t.swc"), os.path.join(folder, "r.json")
        subprocess.run([program, "sprout", "-o", tree, "--report", path, "--quiet", *options.split()], check=True)
        with open(tree, encoding="utf-8") as file:
            rows = [line.split() for line in file if line.strip() and not line.startswith("#")]
        with open(path, encoding="utf-8") as file:
            report = json.load(file)
    return [tuple(map(float, row[2:5])) for row in rows], [int(row[6]) - 1 if row[6] != "-1" else -1 for row in rows], report


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def length(a):
    return math.sqrt(sum(x * x for x in a))


def unit(a):
    return tuple(x / length(a) for x in a)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def laterals(places, parents):
    """Returns nodes with segments shorter than the segment that they branch from, because each order is shorter."""
    way = [minus(p, places[q]) if q >= 0 else None for p, q in zip(places, parents)]
    return [i for i, q in enumerate(parents) if q >= 0 and parents[q] >= 0 and length(way[i]) < 0.99 * length(way[q])], way


def mean_and_deviation(values):
    mean = sum(values) / len(values)
    return mean, math.sqrt(sum((v - mean) ** 2 for v in values) / len(values))


def angles(program):
    print("| asked: angle, deviation, degrees | laterals | measured: mean | deviation |\n| --- | --: | --: | --: |")
    for angle, spread in ((30, 0), (30, 6), (55, 10), (85, 5)):
        places, parents, _ = sprout(program, "%s --branching-angle %g --branching-spread %g" % (STRAIGHT, angle, spread))
        found, way = laterals(places, parents)
        measured = [math.degrees(math.acos(max(-1, min(1, dot(unit(way[i]), unit(way[parents[i]])))))) for i in found]
        print("| %g, %g | %d | %.2f | %.2f |" % (angle, spread, len(found), *mean_and_deviation(measured)))


def turns(program):
    print("\n| asked: degrees from node to node | laterals of the stem | measured: mean | deviation |\n| --- | --: | --: | --: |")
    for turn in (90, 137.5, 180):
        places, parents, _ = sprout(program, "%s --phyllotaxis %g --apical-dominance 0 --branching-spread 0" % (STRAIGHT, turn))
        found, way = laterals(places, parents)
        side = {round(places[parents[i]][2] / 0.12): math.degrees(math.atan2(way[i][1], way[i][0]))
                for i in found if math.hypot(*places[parents[i]][:2]) < 1e-4}
        steps = [(side[k + 1] - side[k]) % 360 for k in side if k + 1 in side]
        print("| %g | %d | %.2f | %.2f |" % (turn, len(side), *mean_and_deviation(steps)))


def stem(places, parents):
    """Returns the height of the stem: the axis that continues with segments as long as the first one."""
    full, top = length(minus(places[1], places[0])), {0}
    for i, q in enumerate(parents):
        if q in top and length(minus(places[i], places[q])) > 0.99 * full:
            top.add(i)
    return max(places[i][2] for i in top)


def leaders(program):
    print("\n| `--apical-control` | nodes | height, m | width, m | stem over height |\n| --- | --: | --: | --: | --: |")
    for control in (0.42, 0.46, 0.5, 0.55, 0.6):
        places, parents, _ = sprout(program, "--apical-control %g" % control)
        height = max(p[2] for p in places)
        width = max(max(p[k] for p in places) - min(p[k] for p in places) for k in (0, 1))
        print("| %g | %d | %.1f | %.1f | %.2f |" % (control, len(places), height, width, stem(places, parents) / height))


def lean(places, parents, root):
    """Returns the mean distance of the tips of a tree from its root along x."""
    own, has_child = {root}, set(parents)
    for i, q in enumerate(parents):
        if q in own:
            own.add(i)
    tips = [places[i][0] - places[root][0] for i in own if i not in has_child]
    return sum(tips) / len(tips)


def neighbours(program, seeds=10):
    print("\n| between two trees | mean of tips from the root, away from the other, m |\n| --- | --: |")
    alone = [lean(*sprout(program, "--seed %d" % seed)[:2], 0) for seed in range(seeds)]
    print("| none beside it | %.2f |" % (sum(alone) / seeds))
    for apart in (1, 2, 4, 8):
        away = []
        for seed in range(seeds):
            places, parents, _ = sprout(program, "--root 0,0,0 --root %g,0,0 --seed %d" % (apart, seed))
            away += [-lean(places, parents, 0), lean(places, parents, 1)]
        print("| %g m | %.2f |" % (apart, sum(away) / len(away)))


def shades(program):
    print("\n| `--shed-light` | nodes | tips | shed | tips below a third of the height |\n| --- | --: | --: | --: | --: |")
    for light in (0, 0.2, 0.4, 0.6):
        places, parents, report = sprout(program, "--shed-light %g" % light)
        has_child, height = set(parents), max(p[2] for p in places)
        low = sum(1 for i, p in enumerate(places) if i not in has_child and p[2] < height / 3)
        print("| %g | %d | %d | %d | %d |" % (light, len(places), report["counts"]["tips"], report["counts"]["shed"], low))


def times(program):
    print("\n| seasons | nodes | ever grown | seconds |\n| --- | --: | --: | --: |")
    for seasons in (15, 20, 24, 28):
        places, _, report = sprout(program, "--seasons %d" % seasons)
        seconds = next(s["seconds"] for s in report["stages"] if s["name"] == "sprout")
        print("| %d | %d | %d | %.3f |" % (seasons, len(places), len(places) + report["counts"]["shed"], seconds))


for table in (angles, turns, leaders, neighbours, shades, times):
    table(sys.argv[1])
