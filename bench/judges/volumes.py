#!/usr/bin/env python3
"""volumes.py COPPICE SKELETON...: volume of surfaces relative to the skeleton's rounded cones, by method and fit, as the table of
docs/user/comparison.md. Prints the measurements of `coppice check`, and the time of meshing in seconds without and with --fit volume."""
import os
import sys
import tempfile

from judged import mesh_and_check


def measure(coppice, skeleton, method, fit, folder):
    judged, _, seconds = mesh_and_check(coppice, skeleton, folder, "--method", method, "--fit", fit)
    return judged["volume"], judged["intersections"]["total"], seconds


def main():
    coppice, skeletons = sys.argv[1], sys.argv[2:]
    print("| skeleton | method | ratio | with `--fit volume` | error | missing, % | crossing pairs | then | s | then, s |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for skeleton in skeletons:
            for method in ("quads", "tetrahedra"):
                bare, pairs, took = measure(coppice, skeleton, method, "surface", folder)
                fitted, then, longer = measure(coppice, skeleton, method, "volume", folder)
                print(f"| {os.path.basename(skeleton)} | {method} | {bare['ratio']:.4f} | {fitted['ratio']:.4f} | "
                      f"{bare['error'] / bare['cones']:.4f} | {fitted['missing_percent']:.2g} | {pairs:,} | {then:,} | "
                      f"{took:.3f} | {longer:.2f} |", flush=True)


main()
