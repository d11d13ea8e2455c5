#!/usr/bin/env python3
"""skins.py COPPICE OUT [SKELETON...] [--blender PROGRAM]: surfaces of skeletons by `coppice mesh` and by Blender's modifier Skin, both subdivided twice and
judged by `coppice check`, as Markdown in OUT/skins.md, for docs/user/topology.md. Without Blender, only the surfaces of `coppice mesh` are measured."""
import json
import os
import shutil

import made_up
from judged import arguments, head, mesh_and_check, row, run

SKIN = os.path.join(os.path.dirname(os.path.abspath(__file__)), "blender_skin.py")
LEVELS = "2"


def skin(blender, coppice, skeleton, path):
    """Returns the report of the check, and the seconds of the modifiers."""
    swc = path + ".swc"
    run(coppice, "convert", skeleton, "-o", swc)
    text = run(blender, "-b", "-P", SKIN, "--", swc, path, LEVELS)
    seconds = next(float(line.split()[1]) for line in text.splitlines() if line.startswith("seconds"))
    return json.loads(run(coppice, "check", path, "--skeleton", skeleton, "--json")), seconds


def cells(judged, seconds):
    return (f"{judged['faces']:,}", judged["open_edges"], f"{judged['intersections']['total']:,}", judged["inverted_faces"], f"{judged['irregular_percent']:.1f}",
            judged["axes"]["severed"], f"{judged['volume']['ratio']:.3f}" if "volume" in judged else "–", f"{1000 * seconds:.0f}")


def main():
    args = arguments(__doc__, more={"--blender": "The program of Blender; default: blender, if it is installed."})
    blender = args.blender or shutil.which("blender")
    made_up.write_all(args.out)
    skeletons = [os.path.join(args.out, f"{name}.swc") for name in ("fork", "neighbours", "laterals", "tree_1")] + args.files
    text = head("skeleton", "surface", "quads", "open edges", "intersecting pairs", "inverted", "irregular vertices, %", "severed", "volume", "ms")
    for skeleton in skeletons:
        name = os.path.splitext(os.path.basename(skeleton))[0]
        judged, _, seconds = mesh_and_check(args.coppice, skeleton, args.out)
        text += row(name, "Coppice", *cells(judged, seconds))
        if blender:
            text += row(name, "Blender's Skin", *cells(*skin(blender, args.coppice, skeleton, os.path.join(args.out, "skin.obj"))))
    with open(os.path.join(args.out, "skins.md"), "w", encoding="utf-8") as file:
        file.write(text)
    print(text)


main()
