#!/usr/bin/python3
"""screened_poisson.py ORIENTED MESH: a surface through points with normals (PLY) by screened Poisson reconstruction [Kazhdan2013], implemented by
Open3D (Debian: python3-open3d), with cells of half the spacing of the points. Prints its time in seconds; exit code 77 if Open3D is missing."""
import math
import sys
import time

try:
    import numpy
    import open3d
except ImportError:
    sys.exit(77)


def main():
    _, source, target = sys.argv
    cloud = open3d.io.read_point_cloud(source)
    middle = cloud.get_center()  # coordinates may be large, and are converted to floats
    cloud.translate(-middle)
    spacing = numpy.median(cloud.compute_nearest_neighbor_distance())
    depth = min(11, math.ceil(math.log2(2 * max(cloud.get_max_bound() - cloud.get_min_bound()) / spacing)))
    start = time.perf_counter()
    surface, _ = open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=depth, n_threads=1)
    print(f"{time.perf_counter() - start:.4f}")
    open3d.io.write_triangle_mesh(target, surface.translate(middle))


main()
