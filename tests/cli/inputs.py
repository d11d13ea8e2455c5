"""Small inputs of the tests of the program: their contents, and create(), which writes them into a folder."""

import json
import math
import os
import pathlib
import re
import struct
import zlib

UNREADABLE = "secret.swc"
FOLDERS = ("old", "folder", "folder.ply")
FILES = {}  # the content of each file, by its name


def add(name, content):
    FILES[name] = content.encode() if isinstance(content, str) else content


def create(folder):
    """Writes all inputs into an empty folder."""
    for name in FOLDERS:
        os.mkdir(f"{folder}/{name}")
    for name, content in FILES.items():
        file = os.open(f"{folder}/{name}", os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
        os.write(file, content)
        os.close(file)
    os.chmod(f"{folder}/{UNREADABLE}", 0)
    os.symlink("folder", f"{folder}/linked")
    os.mkfifo(f"{folder}/never.ply")


def box_obj(low, high, before):
    """Returns a box as OBJ; its vertex numbers follow that many earlier vertices."""
    vertices = re.sub(r"v (\S+) (\S+) (\S+)",
                      lambda v: "v %g %g %g" % tuple((low, high)[int(v[k + 1]) > 0][k] for k in range(3)), CUBE)
    return vertices + re.sub(r"\d+", lambda i: str(int(i[0]) + before), "".join(CUBE_FACES))


CUBE = "".join(f"v {x} {y} {z}\n" for z in (-1, 1) for y in (-1, 1) for x in (-1, 1))
CUBE_FACES = ["f 1 3 4 2\n", "f 5 6 8 7\n", "f 1 2 6 5\n", "f 3 7 8 4\n", "f 1 5 7 3\n", "f 2 4 8 6\n"]
TREE = "1 1 0 0 0 0.2 -1\n2 1 0 0 1 0.15 1\n3 1 0.5 0 1.8 0.1 2\n4 1 -0.5 0 1.8 0.1 2\n"


add("tree.swc", TREE)
# A branch that returns and runs through its own stem to the other side.
add("loop.swc", "1 1 0 0 0 0.1 -1\n2 1 0 0 4 0.1 1\n3 1 4 0 4 0.1 2\n4 1 4 0 2 0.05 3\n5 1 1 0 2 0.05 4\n6 1 -2 0 2 0.05 5\n")
# Two trees: a stem, and one that crosses it in several segments.
add("crossed.swc", "1 1 0 0 0 0.1 -1\n2 1 0 0 2 0.1 1\n3 1 -1 0.02 1 0.04 -1\n" +
    "".join("%d 1 %g 0.02 1 0.04 %d\n" % (4 + i, -0.8 + 0.2 * i, 3 + i) for i in range(10)))
# A trunk with two laterals, one of which forks: six branches that begin at branch nodes.
add("twigs.swc", "1 1 0 0 0 0.2 -1\n2 1 0 0 1 0.18 1\n3 1 0 0 2 0.15 2\n4 1 0 0 3 0.1 3\n5 1 1 0 1.5 0.1 2\n"
    "6 1 1.6 0 2 0.07 5\n7 1 1.2 0.6 2 0.05 5\n8 1 -0.9 0 2.6 0.08 3\n")
# A stem that tapers to a fiftieth, with a lateral at every third node.
add("thinning.swc", "1 1 0 0 0 0.3 -1\n" + "".join("%d 1 0 0 %g %g %d\n" % (i + 1, 0.5 * i, 0.3 * 0.8 ** i, i) for i in range(1, 18)) +
    "".join("%d 1 %g %g %g %g %d\n" % (19 + k, math.cos(2 * k), math.sin(2 * k), 1.5 * k + 2.2, 0.1 * 0.8 ** (3 * k + 3), 3 * k + 4)
            for k in range(4)))
add("inferred.json", json.dumps({"format": "coppice-skeleton", "parent": [-1, 0, 1], "position": [[0, 0, 0], [0, 0, 1], [0, 0, 2]],
                                 "radius": [0.3, 0.3, 0.3], "evidence": [1, 1, 0]}))
add("sprout.coppice", "sprout tree root=0,0,0 root=2,0,0 seasons=7 seed=2\nradii tree\n")
add("material.coppice", "loadtree t tree.swc\nmaterial wood oak width=32\nmesh t uv=bark tile=0.1 material=wood displace=true\nsave t out.obj kind=mesh\nsave t out.glb kind=mesh\n")
add("material_slots.coppice", "loadtree t tree.swc\nmaterial wood oak width=32\ncutmaterial disc oak size=32\nmesh t uv=bark material=wood twig_material=wood twig_diameter=0.1 "
    "cut_material=disc\nsave t out.glb kind=mesh\nsave t out.obj kind=mesh\n")
add("material_of_files.coppice", "loadtree t tree.swc\nloadmaterial m bark_color.png\nmesh t uv=bark material=m\nsave t out.usda kind=mesh\n")
add("material_without_uv.coppice", "loadtree t tree.swc\nmaterial wood oak width=32\nmesh t material=wood\n")
add("material_missing.coppice", "loadmaterial m none_color.png\n")
add("small.coppice", "sphere s radius=0.01\n")
add("former.coppice", "loadtree t tree.swc\nmesh t m levels=1 passes=3 quality=0.1\nsave m out.ply\n")
add("neuron.swc", "1 1 0 0 0 5 -1\n2 3 0 0 150 1 1\n3 3 0 0 250 1 2\n")
add("tree_cm.swc", "1 1 0 0 0 20 -1\n2 1 0 0 100 15 1\n3 1 50 0 180 10 2\n4 1 -50 0 180 10 2\n")
sketch = {"format": "coppice-sketch", "version": 1,
          "views": [{"name": side, "orthographic": side, "pixels_per_metre": 100, "origin": [200, 300]} for side in ("front", "side")],
          "branches": [{"name": "stem", "strokes": {side: {"points": [[200, 300], [200, 100]], "widths": [20, 10]} for side in ("front", "side")}},
                       {"name": "lateral", "parent": "stem", "strokes": {"front": {"points": [[200, 200], [240, 150], [260, 110]]},
                                                                         "side": {"points": [[200, 200], [230, 150], [250, 110]]}}}]}
add("fork.swc", "1 1 0 0 0 0.1 -1\n2 1 0 0 1 0.075 1\n3 1 0 0 2 0.05 2\n4 1 0.4 0.3 1.5 0.032 2\n5 1 0.6 0.5 1.9 0.0225 4\n")
add("fork.sketch.json", json.dumps(sketch))
chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
picture = lambda rows: (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 400, 320, 8, 2, 0, 0, 0)) +
                        chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) + chunk(b"IEND", b""))
heights = lambda width, height, bits, chunks, rows: (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)) + chunks +
                                                    chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) + chunk(b"IEND", b""))
wave = b"".join(struct.pack(">H", 65535 * (x % 32 < 16)) for x in range(64))
scale = chunk(b"pCAL", b"height\0" + struct.pack(">iiBB", 0, 65535, 0, 2) + b"m\0" + b"0\0" + b"0.01")
bark_height = heights(64, 64, 16, scale, [wave] * 64)
add("bark_height.png", bark_height)
add("plain_height.png", heights(64, 64, 16, b"", [wave] * 64))
add("grey_height.png", heights(64, 1, 8, b"", [b"\x80" * 64]))
add("cut_height.png", bark_height[:-60])
add("huge_height.png", heights(100000, 100000, 16, scale, [wave]))
sky = b"\x80\xc0\xff"
add("photo.png", picture([sky * 400] * 320))
add("bark_color.png", picture([b"\xc0\x20\x10" * 400] * 320))
add("bark_normal.png", picture([b"\x80\x80\xff" * 400] * 320))
add("other_color.png", b"no image\n")
add("moss_color.png", picture([b"\x20\x80\x20" * 400] * 320))
add("twig_color.png", picture([b"\x80\x80\x80" * 400] * 320))
add("slots.obj", "v 0 -1 0\nv 0 1 0\nv 0 1 1\nv 0 -1 1\nv 0 1 2\nv 0 -1 2\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl bark\nf 1/1 2/2 3/3 4/4\nusemtl twig\nf 4/1 3/2 5/3 6/4\n")
add("attributes.ply", "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float order\nproperty float radius\nproperty float distance\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 -1 0 0 0.1 0\n0 1 0 0 0.1 0\n0 1 2 3 0.01 2\n0 -1 2 3 0.01 2\n4 0 1 2 3\n")
add("square.obj", "v 0 -1 0\nv 0 1 0\nv 0 1 2\nv 0 -1 2\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n")
add("bar.png", picture([sky * 400] * 100 + [sky * 190 + b"\x40\x30\x20" * 20 + sky * 190] * 200 + [sky * 400] * 20))
add("bar.sketch.json", json.dumps({"format": "coppice-sketch", "version": 1, "views": [view | {"image": "bar.png"} for view in sketch["views"]]}))
add("broken.sketch.json", json.dumps(sketch).replace('"parent": "stem"', '"parent": "trunk"'))
add("torn.sketch.json", json.dumps(sketch).replace("[230, 150], [250, 110]", "[230, 250], [250, 290]"))
add("messy.swc", "2 1 0 0 1 0.15 1\n1 1 0 0 0 0.2 -1\n3 1 0 0 2 0 2\n")
add("roots.rsml", "<rsml><metadata><unit>cm</unit></metadata><scene><plant><root><geometry><polyline><point x='0' y='0'/><point x='0' y='9'/>"
    "</polyline></geometry><functions><function name='diameter'><sample>0.4</sample><sample>0.2</sample></function></functions><root>"
    "<geometry><polyline><point x='0' y='4'/><point x='3' y='6'/></polyline></geometry></root></root></plant></scene></rsml>\n")
head = "CODE:\tFORM-A\nCLASSES:\nP\t1\nA\t2\nN\t3\nFEATURES:\nXX\tREAL\nYY\tREAL\nZZ\tREAL\nTopDia\tREAL\nMTG:\nENTITY-CODE\t\tXX\tYY\tZZ\tTopDia\n"
add("branch.mtg", head + "/P1\n^/A1/N1\t\t0\t0\t0\t0.4\n^<N2\t\t0\t0\t2\t0.3\n\t+A2/N1\t1\t0\t3\t0.2\n^<N3\t\t0\t0\t4\t0.2\n")
add("shapeless.mtg", head + "/P1\n^/A1/N1<N2\n")
add("torn.rsml", "<rsml><scene>\n<plant></scene></rsml>\n")
add("broken.swc", "1 1 0 0 0 0.2 -1\n2 1 0 0 1 0.1 1\n2 1 0 0 2 0.1 1\n")
add("lines.obj", "v 0 0 0\nv 0 0 1\nv 0 0 2\nl 1 2 3\n")
add("cube.obj", CUBE + "".join(CUBE_FACES))
add("open.obj", CUBE + "".join(CUBE_FACES[1:]))
# A stem with a branch; its section above 1.7 m is detached.
add("torn.obj", box_obj((-0.1, -0.1, 0), (0.1, 0.1, 1.6), 0) + box_obj((-0.1, -0.1, 1.7), (0.1, 0.1, 2), 8))
# A stem and a bar across it, for cross.swc.
add("crossed.obj", box_obj((-0.1, -0.1, 0), (0.1, 0.1, 2), 0) + box_obj((-0.5, -0.05, 0.95), (0.5, 0.05, 1.05), 8))
add("cross.swc", "1 1 0 0 0 0.1 -1\n2 1 0 0 1.2 0.1 1\n3 1 0 0 2 0.1 2\n4 1 -0.1 0 1 0.05 -1\n5 1 0.5 0 1 0.05 4\n")
add("empty.swc", "")
# Rings of 16 points on a stem of radius 0.1 and 2 m.
stem = [(0.1 * math.cos(math.pi * (i / 8 + k % 2 / 16)), 0.1 * math.sin(math.pi * (i / 8 + k % 2 / 16)), 0.04 * k)
        for k in range(51) for i in range(16)]
# A stem of 4 m with a limb that ends far too thick; and the same next to a plain stem.
SWOLLEN = "1 1 0 0 0 0.1 -1\n2 1 0 0 4 0.1 1\n3 1 2 0 6 0.6 2\n"
add("swollen.swc", SWOLLEN)
add("swollen_two.swc", SWOLLEN + "4 1 9 0 0 0.1 -1\n5 1 9 0 6 0.02 4\n")
add("burl.swc", "1 1 0 0 0 0.1 -1\n2 1 0 0 1 0.4 1\n3 1 0 0 2 0.1 2\n")  # the stem, swollen in the middle
rows = ["%.4f %.4f %.4f" % p for p in stem]
add("stem.obj", re.sub(r"v (\S+) (\S+) (\S+)", lambda v: "v %g %g %d" % (int(v[1]) / 10, int(v[2]) / 10, int(v[3]) + 1),
                       CUBE) + "".join(CUBE_FACES))
add("stem.swc", "1 1 0 0 0 0.1 -1\n2 1 0 0 2 0.1 1\n")  # the skeleton of these points
add("stem.xyz", "\n".join(rows))
add("slice.xyz", "\n".join(rows[400:448]))
# Three balls of leaves next to the top of the stem, of 150 points each along a spiral that fills them evenly.
leaves = []
for x, y, z in ((0.5, 0, 1.8), (-0.4, 0.3, 1.6), (0, -0.5, 2.1)):
    for i in range(150):
        r, up, turn = 0.2 * (i * 0.618034 % 1) ** (1 / 3), 1 - (2 * i + 1) / 150, 2.399963 * i
        wide = r * math.sqrt(1 - up * up)
        leaves.append("%.4f %.4f %.4f" % (x + wide * math.cos(turn), y + wide * math.sin(turn), z + r * up))
add("leafy.xyz", "\n".join(rows + leaves))
# Three stems of 4 m on a slope, each with two branches, and the ground around them.
plot = ["%.4f %.4f %.4f" % (0.25 * i, 0.25 * k, 0.05 * i) for i in range(33) for k in range(25)]
for x, y, r in ((1.5, 1.5, 0.1), (4.5, 2, 0.12), (3, 4.5, 0.08)):
    plot += ["%.4f %.4f %.4f" % (x + r * px / 0.1, y + r * py / 0.1, 0.2 * x + 2 * pz) for px, py, pz in stem]
    plot += ["%.4f %.4f %.4f" % (x + 0.02 * k * side, y + 0.03 * math.sin(k), 0.2 * x + 3 + 0.01 * k + 0.03 * math.cos(k))
             for k in range(40) for side in (-1, 1)]
add("plot.xyz", "\n".join(plot))
add("plot_strong.txt", "x y z intensity\n" + "\n".join("%s %d" % (row, i % 7) for i, row in enumerate(plot)))


def make_las(points, ids):
    """LAS 1.4 of point format 6, in millimetres, with the extra dimension PredInstance and a coordinate system."""
    def record(user, number, data):
        return struct.pack("<H16sHH32x", 0, user, number, len(data)) + data
    records = record(b"LASF_Projection", 2112, b'PROJCS["UTM 32N",AUTHORITY["EPSG","25832"]]\0')
    records += record(b"LASF_Spec", 4, struct.pack("<2xBB32s156x", 5, 0, b"PredInstance"))
    head = struct.pack("<4s2xH16xBB64x4xHIIBHI20x6d48x8x8xIQ120x", b"LASF", 16, 1, 4, 375, 375 + len(records), 2, 6, 34, 0,
                       0.001, 0.001, 0.001, 0, 0, 0, 0, len(points))
    return head + records + b"".join(
        struct.pack("<3iHBBBBhHdI", *(round(1000 * float(c)) for c in p.split()), 0, 17, 0, 1, 0, 0, 0, 0, i) for p, i in zip(points, ids))


# The same, with the ids 7, 4 and 12 for these trees.
add("plot_ids.las", make_las(plot, [0] * 825 + [i for i in (7, 4, 12) for _ in range(len(stem) + 80)]))
add("old/tree_099.swc", TREE)
add("distances.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float distance\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n0 0 0 -0.1 250 20 20\n1 0 0 0.1 20 250 20\n0 1 0 0.1 20 20 250\n")
# That stem as class 5, with 400 points of the ground and three of noise.
classed = ["x y z classification"] + [row + " 5" for row in rows]
classed += ["%.2f %.2f 0 2" % (0.2 * (i % 20) - 2, 0.2 * (i // 20) - 2) for i in range(400)] + ["0 0 9 7", "1 0 9 7", "0 1 9 7"]
add("classed.xyz", "\n".join(classed))
add("leafy_far.xyz", "\n".join("%d %s" % (5000, row) for row in ("0 0", "1 0", "1 1")))
add("stem.txt", "".join(row + " 1 200 90 40\n" for row in rows))
add("tree.txt", TREE)
add("stem.ply", "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
    "end_header\n" % len(rows) + "\n".join(rows) + "\n")
add("photo.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF\0\1\1\0\0\1\0\1\0\0\xff\xd9")
add("notes.md", "# Notes\n\nThe oak was scanned in May.\n")
add("named.txt", '"id" "X" "Y" "Z"\n1001 0 0 0\n1002 1 0 0\n1003 1 2 3\n')
add("unnamed.txt", "id,height,girth\n1,2,3\n")
add("points.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n1 2 3\n")
add("long.xyz", "0 0 0\n500 1 2\n9 0 0\n")
add("gap.csv", "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius\n"
    "1,0,0,0,0,0,0,1,0.1\n2,1,0,0,1.5,0,0,2,0.1\n")
# A tree of 8 m with a branch, and two sections of its crown that no cylinder connects to it.
add("crumbs.csv", "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius,branchOrder,branchID\n"
    "1,0,0,0,0,0,0,4,0.1,0,1\n2,1,0,0,4,0,0,8,0.08,0,1\n3,1,0,0,4,3,0,5,0.03,1,2\n"
    "4,0,3.5,0,5,4,0,5.2,0.02,2,3\n5,0,0,1,6,0,2,6.5,0.02,2,4\n")
# Two trees of one table that numbers the cylinders of each, without parents.
add("pair.csv", "treeID;startX;startY;startZ;endX;endY;endZ;Diameter (cm)\n"
    "A1;0;0;0;0;0;3;20\nB2;9;0;0;9;0;3;30\nA1;0;0;3;0;1;6;10,5\nB2;9;0;3;9;1;5;20\n")
add("blocks.txt", "radius (m)\tlength (m)\tstart_point\taxis_direction\tparent\textension\tbranch\tbranch_order\n"
    "0.1\t2\t0\t0\t0\t0\t0\t1\t0\t2\t1\t0\n0.1\t1\t0\t0\t2\t0\t0\t1\t1\t0\t1\t0\n"
    "order\tparent\tdiameter (m)\tvolume (L)\n0\t0\t0.2\t94\nTotalVolume\t94.2\nDBHqsm\t0.2\n")
add("treegraph.json", json.dumps({"name": "oak", "cyls": json.dumps({name: dict(enumerate(column)) for name, column in {
    "p1": [1, 2], "p2": [0, 1], "sx": [0, 0], "sy": [0, 0], "sz": [2, 3], "ax": [0, 0], "ay": [0, 0], "az": [-1, -1],
    "radius": [0.1, 0.1], "length": [2, 1], "nbranch": [0, 0], "is_tip": [False, True]}.items()})}))
add("two.xyz", "0 0 0\n0 0 1\n")
las = bytearray(227)
las[0:4], las[24:26], las[94:96], las[96:100] = b"LASF", b"\x01\x02", b"\xe3\x00", b"\xe3\x00\x00\x00"
las[104], las[105], las[107] = 0x80, 20, 1  # one compressed point of 20 bytes
las[131:155] = struct.pack("<3d", 0.01, 0.01, 0.01)
add("cut.laz", bytes(las))
add("scan.laz", (pathlib.Path(__file__).parent / "../io_points/laz/format7.laz").read_bytes())
add("cell.asc", "; a cell\n( (Color Blue)\n  (Axon)\n  (1 2 3 0.5)\n)\n")
add("grid.asc", "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n3 4\n")
add("cell.h5", b"\x89HDF\r\n\x1a\n points structure")
add("comma.swc", "1 1 0,0 0,5 0,0 0,1 -1\n2 1 0,0 0,5 1,0 0,1 1\n")


def make_e57(points):
    """E57 of one scan in doubles, in one packet."""
    def crc32c(data):
        crc = 0xffffffff
        for byte in data:
            crc ^= byte
            for _ in range(8):
                crc = crc >> 1 ^ (0x82f63b78 if crc & 1 else 0)
        return crc ^ 0xffffffff
    streams = [struct.pack("<%dd" % len(points), *axis) for axis in zip(*points)]
    packet = struct.pack("<BBHH3H", 1, 0, 12 + 3 * len(streams[0]) - 1, 3, *map(len, streams)) + b"".join(streams)
    section = struct.pack("<B7xQQQ", 1, 32 + len(packet), 48 + 32, 0) + packet
    fields = "".join('<cartesian%s type="Float"/>' % axis for axis in "XYZ")
    xml = ('<e57Root><data3D><vectorChild><points type="CompressedVector" fileOffset="48" recordCount="%d"><prototype>%s'
           "</prototype></points></vectorChild></data3D></e57Root>" % (len(points), fields)).encode()
    size = -(-(48 + len(section) + len(xml)) // 1020)  # pages
    head = struct.pack("<8sII4Q", b"ASTM-E57", 1, 0, 1024 * size, 48 + len(section), len(xml), 1024)
    content = (head + section + xml).ljust(1020 * size, b"\0")
    pages = [content[i:i + 1020] for i in range(0, len(content), 1020)]
    return b"".join(page + struct.pack(">I", crc32c(page)) for page in pages)


add("scan.e57", make_e57([(0, 0, 0), (1, 0, 0), (1, 2, 3)]))
add("cut.e57", make_e57([(0, 0, 0)])[:-1])
add("rays.ply", "ply\nformat ascii 1.0\nelement vertex 3\n" +
    "".join("property double %s\n" % name for name in ("x", "y", "z", "time", "nx", "ny", "nz")) +
    "".join("property uchar %s\n" % name for name in ("red", "green", "blue", "alpha")) +
    "end_header\n0 0 0 1 0 0 5 9 9 9 255\n1 0 0 2 0 0 5 9 9 9 0\n1 2 3 3 0 0 5 9 9 9 128\n")
add("cut.las", make_las(plot[:10], [1] * 10)[:-40])
add("ids.coppice", "extract all plot_ids.las trees_by=ids\nsave all ids.json\n")
add("cut.coppice", "extract all cut.las\nsave all cut.swc\n")
add("load_cut.coppice", "pointset load all cut.las\n")
add("truncated.coppice", "extract all cut.las allow_truncated=yes\nsave all cut.swc\n")
add("scan.las.gz", b"\x1f\x8b\x08\0")
add("scan.pts", "3\n0 0 0 -700 1 2 3\n1 0 0 800 1 2 3\n1 2 3 0 1 2 3\n")
add("scan.ptx", "1\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 0 0 1\n0 0 0 0.5\n1 0 0 0.5\n1 2 3 0.5\n")
add("cut.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 100\nproperty float x\nproperty float y\n"
    "property float z\nelement face 50\nproperty list uchar int vertex_indices\nend_header\n1234")
add("cut.glb", b"glTF\x02\x00\x00\x00\xff\xff\x00\x00")
add(UNREADABLE, TREE)
add("tree.coppice", "sphere s\npointset gen s poisson count=200\n"
    "grow s s root=0,0,-1.5 influence_radius=2 kill_radius=0.2 step=0.1\nmesh s levels=1\ndescribe s\n"
    "save s s.ply kind=points\n")
add("ball.coppice", "sphere ball\n")
add(
    "leafed.coppice",
    "let age = 1\nlimb tree 0,0,0 0,0,1 radius=0.02\nsize tree height=${age}\nmesh tree levels=1\n"
    "leaves tree oak min_order=0 max_radius=1 shoot_length=1\n",
)
add("fault.coppice", "let age = 1\nlimb tree 0,0,0\nmesh tree\n")
add("late.coppice", "sphere s\npointset gen s poisson count=200\nsave s s.ply kind=points\npolygonize s\n")
add("many.coppice", "sphere s\npointset gen s poisson count=20000000\n")
# Cut flat at its base, which is twenty times as wide as it is high.
add("stump.swc", "1 1 0 0 0 10 -1\n2 1 0 0 1 0.1 1\n")
add("wrong.coppice", "sphere s\nshpere t\n")
add("edits.txt", "# a node more\nsplit 3; append 3 0 0 1\nprune solid=ball; undo\n")
node = lambda i, place: {"id": i, "place": place, "order": 0, "along": 0.5, "length": 1, "radius": 0.1}
add("order.txt", "split 3 parts=4; prune order=0\n")
add("cycle.txt", "split 3; graft 1 2\n")
add("saved.edits.json", json.dumps({"format": "coppice-edits", "version": 1, "base": [0, 0, 0], "size": 1.8, "edits": [
    {"command": "split 1", "nodes": [node(1, [0, 0, 1 / 1.8])]}, {"command": "delete 9", "nodes": [node(9, [-2, -1, 0])]}]}))
add("lines.coppice", "list\nscale bal 2\nquit\nlist\n")
add("variables.coppice", 'let n = 2\nlet name = "ball"\nfor i in 1..n\n  sphere ${name}${i} radius=${random(1, 2)}\n'
    '  pointset gen ${name}${i} count=${10 * n}\nend\ndescribe ${name}1\n')
add("misspelt.coppice", "let height = 2\nrepeat 2\n  sphere s radius=${hieght}\nend\n")
add("loops.coppice", "for i in 1..2\nsphere s${i}\nend\nlist\nrepeat 2\n")
