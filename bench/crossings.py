#!/usr/bin/env python3
"""crossings.py COPPICE SKELETON...: quads that cross before and after remeshing, and what that costs, as the table of
docs/user/comparison.md. The counts are those of `coppice check`; quality and volume are those after remeshing."""
import json
import os
import subprocess
import sys
import tempfile


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 1):  # 1: a check failed, which is a figure here
        sys.exit(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.stdout


def measure(coppice, skeleton, rounds, folder):
    mesh, report = os.path.join(folder, "mesh.ply"), os.path.join(folder, "report.json")
    run(coppice, "mesh", skeleton, "-o", mesh, "--remesh-rounds", str(rounds), "--report", report)
    judged = json.loads(run(coppice, "check", mesh, "--skeleton", skeleton, "--json"))
    with open(report, encoding="utf-8") as file:
        made = json.load(file)
    seconds = next(s["seconds"] for s in made["stages"] if s["name"] == "mesh")
    return judged, made["counts"], seconds


def main():
    coppice, skeletons = sys.argv[1], sys.argv[2:]
    print("| skeleton | pairs before | after | parts | handles | quads before | after | scaled Jacobian p1 | inverted | volume, % of cones, before | after | s before | after |")
    print("| --- " * 13 + "|")
    with tempfile.TemporaryDirectory() as folder:
        for skeleton in skeletons:
            before, was, took = measure(coppice, skeleton, 0, folder)
            after, made, longer = measure(coppice, skeleton, 12, folder)
            shape = after["scaled_jacobian"]
            print(f"| {os.path.basename(skeleton)} | {before['intersections']['total']:,} | {after['intersections']['total']:,} | "
                  f"{after['components']} | {after['components'] - after['euler'] // 2} | {was['quads']:,} | {made['quads']:,} | "
                  f"{shape['p1']:.2f} | {after['inverted_faces']} | {100 * before['volume']['ratio']:.1f} | {100 * after['volume']['ratio']:.1f} | "
                  f"{took:.3f} | {longer:.3f} |", flush=True)


main()
