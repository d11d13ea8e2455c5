"""What the benches of other people's skeletons share: a mesh made and judged by the program itself."""
import argparse
import json
import os
import subprocess
import sys


def arguments(text, files="skeletons to measure besides what is made up", more=None):
    """Of a judge that writes tables into a folder; `more` are options of its own, with what they are."""
    parser = argparse.ArgumentParser(description=text)
    parser.add_argument("coppice", help="the program")
    parser.add_argument("out", help="folder for the tables")
    parser.add_argument("files", nargs="*", help=files)
    for option, meaning in (more or {}).items():
        parser.add_argument(option, help=meaning)
    parser.add_argument("--small", action="store_true", help="little, once: a trial of the script")
    told = parser.parse_intermixed_args()
    os.makedirs(told.out, exist_ok=True)
    return told


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 1):  # 1: a check failed, which is a figure here
        sys.exit(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.stdout


def mesh(coppice, skeleton, path, *options):
    """Returns the counts of meshing, and the seconds of each of its stages."""
    report = path + ".report.json"
    run(coppice, "mesh", skeleton, "-o", path, *options, "--report", report)
    with open(report, encoding="utf-8") as file:
        made = json.load(file)
    seconds = {}
    for stage in made["stages"]:  # some run twice
        seconds[stage["name"]] = seconds.get(stage["name"], 0) + stage["seconds"]
    return made["counts"], seconds


def mesh_and_check(coppice, skeleton, folder, *options):
    """Returns what `coppice check` says of the mesh, the counts of meshing, and the seconds it took."""
    path = os.path.join(folder, "mesh.ply")
    counts, seconds = mesh(coppice, skeleton, path, *options)
    return json.loads(run(coppice, "check", path, "--skeleton", skeleton, "--json")), counts, seconds["mesh"]


def in_turn(coppice, skeleton, folder, ways, runs):
    """Of every way to mesh: what `coppice check` says, the counts, and the least seconds of each stage over all runs, of the ways in turn."""
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
    """A row of a table in Markdown."""
    return "| " + " | ".join(str(c) for c in cells) + " |\n"


def head(*cells):
    """The head of a table, and the line below it."""
    return row(*cells) + row(*["---"] * len(cells))
