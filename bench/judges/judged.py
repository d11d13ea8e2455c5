"""Common code of the benchmarks of external skeletons: meshing and checking with the program itself."""
import argparse
import json
import os
import subprocess
import sys


def arguments(text, files="Additional skeletons to measure.", more=None):
    """Parses the arguments of a script that writes tables into a folder; `more` are additional options with their help texts."""
    parser = argparse.ArgumentParser(description=text)
    parser.add_argument("coppice", help="The coppice program.")
    parser.add_argument("out", help="Folder for the tables.")
    parser.add_argument("files", nargs="*", help=files)
    for option, meaning in (more or {}).items():
        parser.add_argument(option, help=meaning)
    parser.add_argument("--small", action="store_true", help="Run once with little data, to test the script.")
    args = parser.parse_intermixed_args()
    os.makedirs(args.out, exist_ok=True)
    return args


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 1):  # 1: a check failed, which is a result here
        sys.exit(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.stdout


def mesh(coppice, skeleton, path, *options):
    """Returns the counts of meshing, and the time of each of its stages in seconds."""
    report = path + ".report.json"
    run(coppice, "mesh", skeleton, "-o", path, *options, "--report", report)
    with open(report, encoding="utf-8") as file:
        made = json.load(file)
    seconds = {}
    for stage in made["stages"]:  # some run twice
        seconds[stage["name"]] = seconds.get(stage["name"], 0) + stage["seconds"]
    return made["counts"], seconds


def mesh_and_check(coppice, skeleton, folder, *options):
    """Returns the report of `coppice check`, the counts of meshing, and its time in seconds."""
    path = os.path.join(folder, "mesh.ply")
    counts, seconds = mesh(coppice, skeleton, path, *options)
    return json.loads(run(coppice, "check", path, "--skeleton", skeleton, "--json")), counts, seconds["mesh"]


def in_turn(coppice, skeleton, folder, ways, runs):
    """Returns for every method the report of `coppice check`, the counts, and the minimum time of each stage over all runs, with the methods in alternation."""
    out = {}
    for _ in range(runs):
        for name, way in ways.items():
            path = os.path.join(folder, "mesh.ply")
            counts, seconds = mesh(coppice, skeleton, path, *way)
            if name in out:
                judged, _, before = out[name]
                seconds = {stage: min(s, before.get(stage, s)) for stage, s in seconds.items()}
            else:
                judged = json.loads(run(coppice, "check", path, "--skeleton", skeleton, "--json"))
            out[name] = (judged, counts, seconds)
    return out


def row(*cells):
    """Returns a row of a table in Markdown."""
    return "| " + " | ".join(str(c) for c in cells) + " |\n"


def head(*cells):
    """Returns the head of a table, and the line below it."""
    return row(*cells) + row(*["---"] * len(cells))
