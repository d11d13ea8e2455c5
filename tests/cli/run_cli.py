#!/usr/bin/env python3
"""Runs the program once in a fresh folder with small inputs and compares exit code, output and files.

Conditions on JSON are key, key.key=value, key<number or key>number, with commas between. They are asked for by a pattern that
starts with "json:", of a file by --report FILE:conditions, and of what was written by --then "COMMAND => conditions": the
command of the program (check, info, compare) is run with --json in the same folder; `picture FILE` looks at a picture and
`text FILE` at lines.
"""

import argparse
import json
import math
import os
import re
import resource
import shlex
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib

SKIPPED = 77
SLOWEST_END = 2  # seconds after a signal; one is promised, but other tests are at work

CUBE = "".join(f"v {x} {y} {z}\n" for z in (-1, 1) for y in (-1, 1) for x in (-1, 1))
CUBE_FACES = ["f 1 3 4 2\n", "f 5 6 8 7\n", "f 1 2 6 5\n", "f 3 7 8 4\n", "f 1 5 7 3\n", "f 2 4 8 6\n"]
TREE = "1 1 0 0 0 0.2 -1\n2 1 0 0 1 0.15 1\n3 1 0.5 0 1.8 0.1 2\n4 1 -0.5 0 1.8 0.1 2\n"


def write(name, content):
    with open(name, "wb") as file:
        file.write(content.encode() if isinstance(content, str) else content)


def box_obj(low, high, before):
    """A box as OBJ, after so many vertices."""
    vertices = re.sub(r"v (\S+) (\S+) (\S+)",
                      lambda v: "v %g %g %g" % tuple((low, high)[int(v[k + 1]) > 0][k] for k in range(3)), CUBE)
    return vertices + re.sub(r"\d+", lambda i: str(int(i[0]) + before), "".join(CUBE_FACES))


def make_inputs():
    write("tree.swc", TREE)
    # A branch that comes back and runs through its own stem, out again on the other side.
    write("loop.swc", "1 1 0 0 0 0.1 -1\n2 1 0 0 4 0.1 1\n3 1 4 0 4 0.1 2\n4 1 4 0 2 0.05 3\n5 1 1 0 2 0.05 4\n6 1 -2 0 2 0.05 5\n")
    # Two trees: a stem, and one that runs across it in steps.
    write("crossed.swc", "1 1 0 0 0 0.1 -1\n2 1 0 0 2 0.1 1\n3 1 -1 0.02 1 0.04 -1\n" +
          "".join("%d 1 %g 0.02 1 0.04 %d\n" % (4 + i, -0.8 + 0.2 * i, 3 + i) for i in range(10)))
    # A trunk with two laterals, of which one forks: six branches that begin at branch nodes.
    write("twigs.swc", "1 1 0 0 0 0.2 -1\n2 1 0 0 1 0.18 1\n3 1 0 0 2 0.15 2\n4 1 0 0 3 0.1 3\n5 1 1 0 1.5 0.1 2\n"
          "6 1 1.6 0 2 0.07 5\n7 1 1.2 0.6 2 0.05 5\n8 1 -0.9 0 2.6 0.08 3\n")
    write("presumed.json", json.dumps({"format": "coppice-skeleton", "parent": [-1, 0, 1], "position": [[0, 0, 0], [0, 0, 1], [0, 0, 2]],
                                       "radius": [0.3, 0.3, 0.3], "evidence": [1, 1, 0]}))
    write("sprout.coppice", "sprout tree root=0,0,0 root=2,0,0 seasons=7 seed=2\nradii tree\n")
    write("small.coppice", "sphere s radius=0.01\n")
    write("neuron.swc", "1 1 0 0 0 5 -1\n2 3 0 0 150 1 1\n3 3 0 0 250 1 2\n")
    write("tree_cm.swc", "1 1 0 0 0 20 -1\n2 1 0 0 100 15 1\n3 1 50 0 180 10 2\n4 1 -50 0 180 10 2\n")
    sketch = {"format": "coppice-sketch", "version": 1,
              "views": [{"name": side, "orthographic": side, "pixels_per_metre": 100, "origin": [200, 300]} for side in ("front", "side")],
              "branches": [{"name": "stem", "strokes": {side: {"points": [[200, 300], [200, 100]], "widths": [20, 10]} for side in ("front", "side")}},
                           {"name": "lateral", "parent": "stem", "strokes": {"front": {"points": [[200, 200], [240, 150], [260, 110]]},
                                                                             "side": {"points": [[200, 200], [230, 150], [250, 110]]}}}]}
    write("fork.swc", "1 1 0 0 0 0.1 -1\n2 1 0 0 1 0.075 1\n3 1 0 0 2 0.05 2\n4 1 0.4 0.3 1.5 0.032 2\n5 1 0.6 0.5 1.9 0.0225 4\n")
    write("fork.sketch.json", json.dumps(sketch))
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    picture = lambda rows: (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 400, 320, 8, 2, 0, 0, 0)) +
                            chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) + chunk(b"IEND", b""))
    sky = b"\x80\xc0\xff"
    write("photo.png", picture([sky * 400] * 320))
    write("bar.png", picture([sky * 400] * 100 + [sky * 190 + b"\x40\x30\x20" * 20 + sky * 190] * 200 + [sky * 400] * 20))
    write("bar.sketch.json", json.dumps({"format": "coppice-sketch", "version": 1, "views": [view | {"image": "bar.png"} for view in sketch["views"]]}))
    write("broken.sketch.json", json.dumps(sketch).replace('"parent": "stem"', '"parent": "trunk"'))
    write("torn.sketch.json", json.dumps(sketch).replace("[230, 150], [250, 110]", "[230, 250], [250, 290]"))
    write("messy.swc", "2 1 0 0 1 0.15 1\n1 1 0 0 0 0.2 -1\n3 1 0 0 2 0 2\n")
    write("roots.rsml", "<rsml><metadata><unit>cm</unit></metadata><scene><plant><root><geometry><polyline><point x='0' y='0'/><point x='0' y='9'/>"
          "</polyline></geometry><functions><function name='diameter'><sample>0.4</sample><sample>0.2</sample></function></functions><root>"
          "<geometry><polyline><point x='0' y='4'/><point x='3' y='6'/></polyline></geometry></root></root></plant></scene></rsml>\n")
    head = "CODE:\tFORM-A\nCLASSES:\nP\t1\nA\t2\nN\t3\nFEATURES:\nXX\tREAL\nYY\tREAL\nZZ\tREAL\nTopDia\tREAL\nMTG:\nENTITY-CODE\t\tXX\tYY\tZZ\tTopDia\n"
    write("branch.mtg", head + "/P1\n^/A1/N1\t\t0\t0\t0\t0.4\n^<N2\t\t0\t0\t2\t0.3\n\t+A2/N1\t1\t0\t3\t0.2\n^<N3\t\t0\t0\t4\t0.2\n")
    write("shapeless.mtg", head + "/P1\n^/A1/N1<N2\n")
    write("torn.rsml", "<rsml><scene>\n<plant></scene></rsml>\n")
    write("broken.swc", "1 1 0 0 0 0.2 -1\n2 1 0 0 1 0.1 1\n2 1 0 0 2 0.1 1\n")
    write("lines.obj", "v 0 0 0\nv 0 0 1\nv 0 0 2\nl 1 2 3\n")
    write("cube.obj", CUBE + "".join(CUBE_FACES))
    write("open.obj", CUBE + "".join(CUBE_FACES[1:]))
    # A stem with a branch; the piece of it above 1.7 m hangs in the air.
    write("torn.obj", box_obj((-0.1, -0.1, 0), (0.1, 0.1, 1.6), 0) + box_obj((-0.1, -0.1, 1.7), (0.1, 0.1, 2), 8))
    # A stem and a bar across it, for cross.swc.
    write("crossed.obj", box_obj((-0.1, -0.1, 0), (0.1, 0.1, 2), 0) + box_obj((-0.5, -0.05, 0.95), (0.5, 0.05, 1.05), 8))
    write("cross.swc", "1 1 0 0 0 0.1 -1\n2 1 0 0 1.2 0.1 1\n3 1 0 0 2 0.1 2\n4 1 -0.1 0 1 0.05 -1\n5 1 0.5 0 1 0.05 4\n")
    write("empty.swc", "")
    # Rings of 16 points on a stem of radius 0.1 and 2 m.
    stem = [(0.1 * math.cos(math.pi * (i / 8 + k % 2 / 16)), 0.1 * math.sin(math.pi * (i / 8 + k % 2 / 16)), 0.04 * k)
            for k in range(51) for i in range(16)]
    write("burl.swc", "1 1 0 0 0 0.1 -1\n2 1 0 0 1 0.4 1\n3 1 0 0 2 0.1 2\n")  # the stem, swollen in the middle
    rows = ["%.4f %.4f %.4f" % p for p in stem]
    write("stem.obj", re.sub(r"v (\S+) (\S+) (\S+)", lambda v: "v %g %g %d" % (int(v[1]) / 10, int(v[2]) / 10, int(v[3]) + 1),
                             CUBE) + "".join(CUBE_FACES))
    write("stem.swc", "1 1 0 0 0 0.1 -1\n2 1 0 0 2 0.1 1\n")  # what these points were laid around
    write("stem.xyz", "\n".join(rows))
    # Three balls of leaves beside the stem's top, of 150 points each, along a spiral that fills them evenly.
    leaves = []
    for x, y, z in ((0.5, 0, 1.8), (-0.4, 0.3, 1.6), (0, -0.5, 2.1)):
        for i in range(150):
            r, up, turn = 0.2 * (i * 0.618034 % 1) ** (1 / 3), 1 - (2 * i + 1) / 150, 2.399963 * i
            wide = r * math.sqrt(1 - up * up)
            leaves.append("%.4f %.4f %.4f" % (x + wide * math.cos(turn), y + wide * math.sin(turn), z + r * up))
    write("leafy.xyz", "\n".join(rows + leaves))
    # Three stems of 4 m on a slope, each with two branches, and the ground around them.
    plot = ["%.4f %.4f %.4f" % (0.25 * i, 0.25 * k, 0.05 * i) for i in range(33) for k in range(25)]
    for x, y, r in ((1.5, 1.5, 0.1), (4.5, 2, 0.12), (3, 4.5, 0.08)):
        plot += ["%.4f %.4f %.4f" % (x + r * px / 0.1, y + r * py / 0.1, 0.2 * x + 2 * pz) for px, py, pz in stem]
        plot += ["%.4f %.4f %.4f" % (x + 0.02 * k * side, y + 0.03 * math.sin(k), 0.2 * x + 3 + 0.01 * k + 0.03 * math.cos(k))
                 for k in range(40) for side in (-1, 1)]
    write("plot.xyz", "\n".join(plot))
    os.mkdir("old")
    write("old/tree_099.swc", TREE)
    write("distances.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float distance\n"
          "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n0 0 0 -0.1 250 20 20\n1 0 0 0.1 20 250 20\n0 1 0 0.1 20 20 250\n")
    # That stem as class 5, amid 400 points of the ground and three of noise.
    classed = ["x y z classification"] + [row + " 5" for row in rows]
    classed += ["%.2f %.2f 0 2" % (0.2 * (i % 20) - 2, 0.2 * (i // 20) - 2) for i in range(400)] + ["0 0 9 7", "1 0 9 7", "0 1 9 7"]
    write("classed.xyz", "\n".join(classed))
    write("leafy_far.xyz", "\n".join("%d %s" % (5000, row) for row in ("0 0", "1 0", "1 1")))
    write("stem.txt", "".join(row + " 1 200 90 40\n" for row in rows))
    write("tree.txt", TREE)
    write("stem.ply", "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
          "end_header\n" % len(rows) + "\n".join(rows) + "\n")
    write("photo.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF\0\1\1\0\0\1\0\1\0\0\xff\xd9")
    write("notes.md", "# Notes\n\nThe oak was scanned in May.\n")
    write("named.txt", '"id" "X" "Y" "Z"\n1001 0 0 0\n1002 1 0 0\n1003 1 2 3\n')
    write("unnamed.txt", "id,height,girth\n1,2,3\n")
    write("points.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n1 2 3\n")
    write("long.xyz", "0 0 0\n500 1 2\n9 0 0\n")
    write("gap.csv", "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius\n"
          "1,0,0,0,0,0,0,1,0.1\n2,1,0,0,1.5,0,0,2,0.1\n")
    write("two.xyz", "0 0 0\n0 0 1\n")
    las = bytearray(227)
    las[0:4], las[24:26], las[94:96], las[96:100] = b"LASF", b"\x01\x02", b"\xe3\x00", b"\xe3\x00\x00\x00"
    las[104], las[105], las[107] = 0x80, 20, 1  # compressed points of 20 bytes, of which there is one
    las[131:155] = struct.pack("<3d", 0.01, 0.01, 0.01)
    write("cut.laz", bytes(las))
    with open(os.path.join(os.path.dirname(__file__), "../io/laz/format7.laz"), "rb") as scan:
        write("scan.laz", scan.read())
    write("cell.asc", "; a cell\n( (Color Blue)\n  (Axon)\n  (1 2 3 0.5)\n)\n")
    write("grid.asc", "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n3 4\n")
    write("cell.h5", b"\x89HDF\r\n\x1a\n points structure")
    write("comma.swc", "1 1 0,0 0,5 0,0 0,1 -1\n2 1 0,0 0,5 1,0 0,1 1\n")
    write("scan.e57", b"ASTM-E57\1\0\0\0")
    write("scan.las.gz", b"\x1f\x8b\x08\0")
    write("scan.pts", "3\n0 0 0 -700 1 2 3\n1 0 0 800 1 2 3\n1 2 3 0 1 2 3\n")
    write("scan.ptx", "1\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 0 0 1\n0 0 0 0.5\n1 0 0 0.5\n1 2 3 0.5\n")
    write("cut.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 100\nproperty float x\nproperty float y\n"
          "property float z\nelement face 50\nproperty list uchar int vertex_indices\nend_header\n1234")
    write("cut.glb", b"glTF\x02\x00\x00\x00\xff\xff\x00\x00")
    write("secret.swc", TREE)
    os.chmod("secret.swc", 0)
    write("tree.coppice", "sphere s\npointset gen s poisson count=200\n"
          "grow s s root=0,0,-1.5 influence_radius=2 kill_radius=0.2 step=0.1\nmesh s levels=1\ndescribe s\n"
          "save s s.ply kind=points\n")
    write("ball.coppice", "sphere ball\n")
    write("late.coppice", "sphere s\npointset gen s poisson count=200\nsave s s.ply kind=points\npolygonize s\n")
    write("many.coppice", "sphere s\npointset gen s poisson count=20000000\n")
    # Cut flat at its base, which is twenty times as wide as it is high.
    write("stump.swc", "1 1 0 0 0 10 -1\n2 1 0 0 1 0.1 1\n")
    write("wrong.coppice", "sphere s\nshpere t\n")
    write("edits.txt", "# a node more\nsplit 3; append 3 0 0 1\nprune solid=ball; undo\n")
    node = lambda i, place: {"id": i, "place": place, "order": 0, "along": 0.5, "length": 1, "radius": 0.1}
    write("order.txt", "split 3 parts=4; prune order=0\n")
    write("cycle.txt", "split 3; graft 1 2\n")
    write("saved.edits.json", json.dumps({"format": "coppice-edits", "version": 1, "base": [0, 0, 0], "size": 1.8, "edits": [
        {"command": "split 1", "nodes": [node(1, [0, 0, 1 / 1.8])]}, {"command": "delete 9", "nodes": [node(9, [-2, -1, 0])]}]}))
    write("lines.coppice", "list\nscale bal 2\nquit\nlist\n")
    write("variables.coppice", 'let n = 2\nlet name = "ball"\nfor i in 1..n\n  sphere ${name}${i} radius=${random(1, 2)}\n'
          '  pointset gen ${name}${i} count=${10 * n}\nend\ndescribe ${name}1\n')
    write("misspelt.coppice", "let height = 2\nrepeat 2\n  sphere s radius=${hieght}\nend\n")
    write("loops.coppice", "for i in 1..2\nsphere s${i}\nend\nlist\nrepeat 2\n")
    os.mkfifo("never.ply")
    os.mkdir("folder")
    os.symlink("folder", "linked")
    os.mkdir("folder.ply")


def value_at(value, path):
    for part in path.split("."):
        if isinstance(value, list) and int(part) < len(value):
            value = value[int(part)]
            continue
        if not isinstance(value, dict) or part not in value:
            return None
        value = value[part]
    return value


def holds(value, sign, expected):
    if value is None or not sign:
        return value is not None
    if sign == "=":
        return value == expected if isinstance(value, str) else value == json.loads(expected)
    return value < float(expected) if sign == "<" else value > float(expected)


def broken(conditions, value):
    """The conditions that do not hold, each with what is there instead."""
    for condition in conditions.split(","):
        path, sign, expected = re.fullmatch(r"([^<>=]+)([<>=]?)(.*)", condition.strip()).groups()
        found = value_at(value, path)
        if not holds(found, sign, expected):
            yield f"{condition.strip()} does not hold: it is {json.dumps(found)}"


def nearest(left, above, corner):
    return min((left, above, corner), key=lambda v: abs(left + above - corner - v))


# How the rows of a PNG predict a byte from those to the left, above, and above on the left.
PREDICTIONS = [lambda left, above, corner: 0, lambda left, above, corner: left, lambda left, above, corner: above,
               lambda left, above, corner: (left + above) // 2, nearest]


def unfiltered(rows, width, depth):
    """The bytes of the rows of a PNG, each of which says first how it is predicted."""
    before = bytes(width * depth)
    for kind, row in rows:
        line, predict = bytearray(depth) + row, PREDICTIONS[kind]
        for i, (above, corner) in enumerate(zip(before, bytes(depth) + before)):
            line[i + depth] = (line[i + depth] + predict(line[i], above, corner)) % 256
        before = bytes(line[depth:])
        yield before


def look_at_picture(name):
    """What can be said of a picture without knowing what it shows: shares are in percent of its pixels."""
    with open(name, "rb") as file:
        data = file.read()
    width, height, bits, kind = struct.unpack(">IIBB", data[16:26])
    depth, packed, at = {2: 3, 6: 4}[kind], b"", 8
    assert data[:8] == b"\x89PNG\r\n\x1a\n" and bits == 8
    while at < len(data):
        size, chunk = struct.unpack(">I4s", data[at:at + 8])
        packed += data[at + 8:at + 8 + size] if chunk == b"IDAT" else b""
        at += size + 12
    raw, stride = zlib.decompress(packed), width * depth + 1
    rows = [(raw[y * stride], raw[y * stride + 1:(y + 1) * stride]) for y in range(height)]
    pixels = [line[i:i + depth] for line in unfiltered(rows, width, depth) for i in range(0, width * depth, depth)]
    share = 100 / len(pixels)
    return {"width": width, "height": height, "shades": len(set(pixels)),
            "clear": share * sum(p[3] == 0 for p in pixels) if depth == 4 else 0,
            "colored": share * sum(max(p[:3]) - min(p[:3]) > 100 for p in pixels)}


def matches(pattern, text):
    if pattern.startswith("json:"):
        return not list(broken(pattern[5:], json.loads(text)))
    return re.search(pattern, text.rstrip("\n") if pattern.endswith("$") else text, re.DOTALL) is not None


def run(program, words, signal_name, limit=None):
    def obey():
        """Before the program starts: NAME=VALUE of setrlimit."""
        if limit:
            name, value = limit.split("=")
            resource.setrlimit(getattr(resource, "RLIMIT_" + name), (int(value), resource.RLIM_INFINITY))

    lines = ""
    if "<" in words:
        with open(words[words.index("<") + 1], encoding="utf-8") as file:
            lines = file.read()
        words = words[:words.index("<")]
    process = subprocess.Popen([program] + words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               text=True, preexec_fn=obey)
    if signal_name:
        time.sleep(0.7)
        if process.poll() is None:
            process.send_signal(getattr(signal, signal_name))
    sent = time.monotonic()
    out, err = process.communicate(lines)
    if signal_name and time.monotonic() - sent > SLOWEST_END:
        err += f"it took {time.monotonic() - sent:.1f} s to end\n"
    return process.returncode, out, err


def look_at_text(name):
    with open(name, encoding="utf-8") as file:
        lines = file.read().splitlines()
    return {"lines": len(lines), "first": lines[0]}


LOOKS = {"picture": look_at_picture, "text": look_at_text}


def judged(program, command, conditions):
    """What another command has to say against the files that were written."""
    words = shlex.split(command)
    if words[0] in LOOKS:
        value = LOOKS[words[0]](words[1])
    else:
        code, out, err = run(program, words + ["--json"], None)
        if code != ("sound=false" in conditions.split(",")):  # a check that is expected to fail ends with 1
            yield f"{command} ends with {code}: {err or out}"
            return
        value = json.loads(out)
    for complaint in broken(conditions, value):
        yield f"{command}: {complaint}"


def complaints(arguments, before, code, out, err):
    if code != arguments.exit:
        yield f"exit code {code} instead of {arguments.exit}"
    for name, pattern, text in (("stdout", arguments.out, out), ("stderr", arguments.err, err)):
        if pattern is not None and not matches(pattern, text):
            yield f"{name} does not match {pattern}"
    if arguments.err and len(err.strip().splitlines()) > 1:
        yield "an error is more than one line"
    for name in filter(None, arguments.gone.split(",")):
        if os.path.exists(name):
            yield f"{name} was left behind"
    if arguments.report:
        name, keys = arguments.report.split(":")
        with open(name, encoding="utf-8") as file:
            yield from broken(keys, json.load(file))
    for judgement in arguments.then:
        yield from judged(arguments.program, *judgement.split(" => "))
    if code not in (0, 1) and set(os.listdir(".")) != before:
        yield f"files were left behind: {set(os.listdir('.')) - before}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--exit", type=int, required=True)
    parser.add_argument("--out")
    parser.add_argument("--err")
    parser.add_argument("--gone", default="")
    parser.add_argument("--report", default="")
    parser.add_argument("--then", action="append", default=[])
    parser.add_argument("--signal")
    parser.add_argument("--limit")
    own, words = sys.argv[1:], ""
    if "--" in own:
        words = " ".join(own[own.index("--") + 1:])
        own = own[:own.index("--")]
    # A value may begin with a dash or be a regular expression: join it to its option.
    joined = own[:1] + [f"{own[i]}={own[i + 1]}" for i in range(1, len(own) - 1, 2)]
    arguments = parser.parse_args(joined)

    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        make_inputs()
        if "secret" in words and os.access("secret.swc", os.R_OK):
            return SKIPPED  # root reads everything
        if "twigs.branches" in words:
            subprocess.run([arguments.program, "library", "add", "twigs.branches", "twigs.swc", "--set-tag", "oak"], check=True, capture_output=True)
        before = set(os.listdir("."))
        code, out, err = run(arguments.program, shlex.split(words), arguments.signal, arguments.limit)
        found = list(complaints(arguments, before, code, out, err))
        os.chdir("/")
    if found:
        print(f"coppice {words}\n" + "\n".join(found) + f"\n--- stdout\n{out}\n--- stderr\n{err}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
