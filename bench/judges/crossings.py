#!/usr/bin/env python3
"""crossings.py COPPICE SKELETON...: intersecting quads before and after remeshing, and its cost, as the table of
docs/user/comparison.md. The counts are from `coppice check`; quality and volume are measured after remeshing."""
import os
import sys
import tempfile

from judged import mesh_and_check


def main():
    coppice, skeletons = sys.argv[1], sys.argv[2:]
    print("| skeleton | pairs before | after | parts | handles | quads before | after | scaled Jacobian p1 | inverted | volume, % of cones, before | after | s before | after |")
    print("| --- " * 13 + "|")
    with tempfile.TemporaryDirectory() as folder:
        for skeleton in skeletons:
            before, was, took = mesh_and_check(coppice, skeleton, folder, "--remesh-rounds", "0")
            after, made, longer = mesh_and_check(coppice, skeleton, folder)
            shape = after["scaled_jacobian"]
            print(f"| {os.path.basename(skeleton)} | {before['intersections']['total']:,} | {after['intersections']['total']:,} | "
                  f"{after['components']} | {after['components'] - after['euler'] // 2} | {was['quads']:,} | {made['quads']:,} | "
                  f"{shape['p1']:.2f} | {after['inverted_faces']} | {100 * before['volume']['ratio']:.1f} | {100 * after['volume']['ratio']:.1f} | "
                  f"{took:.3f} | {longer:.3f} |", flush=True)


main()
