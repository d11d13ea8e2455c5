"""What the benches of other people's skeletons share: a mesh made and judged by the program itself."""
import json
import os
import subprocess
import sys


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 1):  # 1: a check failed, which is a figure here
        sys.exit(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.stdout


def mesh_and_check(coppice, skeleton, folder, *options):
    """Returns what `coppice check` says of the mesh, the counts of meshing, and the seconds it took."""
    mesh, report = os.path.join(folder, "mesh.ply"), os.path.join(folder, "report.json")
    run(coppice, "mesh", skeleton, "-o", mesh, *options, "--report", report)
    judged = json.loads(run(coppice, "check", mesh, "--skeleton", skeleton, "--json"))
    with open(report, encoding="utf-8") as file:
        made = json.load(file)
    return judged, made["counts"], next(s["seconds"] for s in made["stages"] if s["name"] == "mesh")
