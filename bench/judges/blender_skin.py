"""blender -b -P blender_skin.py -- SKELETON.swc MESH.obj LEVELS: writes the surface that Blender's modifier Skin creates around a skeleton, subdivided, and
prints the seconds of both modifiers."""
import sys
import time

import bpy


def read_nodes(path):
    with open(path, encoding="utf-8") as file:
        return [line.split() for line in file if line.strip() and not line.startswith("#")]


def make_object(nodes):
    index = {node[0]: i for i, node in enumerate(nodes)}
    edges = [(index[node[6]], i) for i, node in enumerate(nodes) if node[6] != "-1"]
    mesh = bpy.data.meshes.new("tree")
    mesh.from_pydata([tuple(map(float, node[2:5])) for node in nodes], edges, [])
    tree = bpy.data.objects.new("tree", mesh)
    bpy.context.collection.objects.link(tree)
    tree.modifiers.new("skin", "SKIN")
    for node, vertex in zip(nodes, mesh.skin_vertices[0].data):
        vertex.radius = (float(node[5]),) * 2
        vertex.use_root = node[6] == "-1"
    return tree


def main():
    source, target, levels = sys.argv[sys.argv.index("--") + 1:]
    tree = make_object(read_nodes(source))
    if int(levels) > 0:
        tree.modifiers.new("subdivision", "SUBSURF").levels = int(levels)
    start = time.perf_counter()
    surface = tree.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    print(f"seconds {time.perf_counter() - start}")
    with open(target, "w", encoding="utf-8") as file:
        file.writelines(f"v {v.co.x:.7g} {v.co.y:.7g} {v.co.z:.7g}\n" for v in surface.vertices)
        file.writelines("f " + " ".join(str(i + 1) for i in p.vertices) + "\n" for p in surface.polygons)


main()
