#!/usr/bin/env python3
"""Tests of the Python module: python3 module_test.py [names of cases]. The environment variable COPPICE_LIBRARY names
libcoppice_c.so. Packages that are not installed skip their cases; trimesh, pyvista and navis are replaced by fakes of
their constructors."""

import gc
import inspect
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
import types
import unittest

import numpy as np

import coppice

FORK = ([[0, 0, 0], [0, 0, 2], [0.7, 0, 3], [-0.7, 0, 3]], [0.1, 0.08, 0.05, 0.05], [-1, 0, 1, 1])


def make_fork():
    return coppice.Skeleton.from_arrays(*FORK)


def make_large():
    """A random walk with branches; its surface takes seconds."""
    rng = np.random.default_rng(1)
    parents = np.arange(-1, 19999)
    parents[1:] -= rng.integers(0, 20, 19999) * (parents[1:] > 20)
    positions = np.zeros((20000, 3))
    for i in range(1, 20000):
        positions[i] = positions[parents[i]] + rng.normal(0, 0.2, 3) + [0, 0, 0.05]
    return coppice.Skeleton.from_arrays(positions, np.full(20000, 0.02), parents)


def module_or_skip(name):
    try:
        return __import__(name)
    except ImportError:
        raise unittest.SkipTest("the package %s is not installed" % name)


class Arrays(unittest.TestCase):
    def test_nodes(self):
        tree = make_fork()
        self.assertEqual(len(tree), 4)
        self.assertEqual(tree.parents.tolist(), FORK[2])
        np.testing.assert_array_equal(tree.positions, np.array(FORK[0], np.float32))
        self.assertEqual(tree.nodes.dtype.names, ("position", "radius", "parent"))
        self.assertEqual(tree.nodes["parent"].tolist(), FORK[2])
        self.assertEqual(tree.units, "m")

    def test_views_share_memory_and_keep_it(self):
        surface = coppice.mesh(make_fork(), levels=2)
        self.assertTrue(np.shares_memory(surface.positions, surface.positions))
        self.assertFalse(surface.positions.flags.writeable)
        positions, before = surface.positions, surface.positions.copy()
        del surface
        gc.collect()
        trash = [coppice.mesh(make_fork(), levels=2) for _ in range(5)]
        np.testing.assert_array_equal(positions, before)
        del trash

    def test_surface_is_closed(self):
        surface = coppice.mesh(make_fork(), levels=2, uv="bark", attributes=True)
        quads = surface.quads
        self.assertEqual(quads.shape, (len(surface), 4))
        # A sphere of quads: V - 2 F + F = 2.
        self.assertEqual(len(surface.positions), len(quads) + 2)
        edges = np.sort(np.stack([quads, np.roll(quads, -1, 1)], 2).reshape(-1, 2), 1)
        self.assertTrue((np.unique(edges, axis=0, return_counts=True)[1] == 2).all())
        self.assertEqual(surface.uv.shape, (4 * len(quads), 2))
        self.assertEqual(set(surface.attributes), {"order", "branch", "distance", "radius"})
        self.assertEqual(surface.attributes["radius"].shape, (len(surface.positions),))
        np.testing.assert_allclose(np.linalg.norm(surface.normals(), axis=1), 1, atol=1e-5)
        self.assertEqual(surface.triangles().shape, (2 * len(quads), 3))

    def test_origin_keeps_precision(self):
        far = coppice.Skeleton.from_arrays(np.array(FORK[0]) + [4e5, 5e6, 100], *FORK[1:])
        np.testing.assert_allclose(far.nodes["position"], np.array(FORK[0]) + [4e5, 5e6, 100], atol=1e-6)

    def test_ids_in_any_order(self):
        tree = coppice.Skeleton.from_arrays(FORK[0][::-1], FORK[1][::-1], [20, 20, 10, -1], [40, 30, 20, 10])
        self.assertEqual(len(tree), 4)
        self.assertEqual(sorted(tree.parents.tolist()), [-1, 0, 1, 1])
        self.assertGreater(tree.report["repairs"]["reordered"], 0)

    def test_surface_from_arrays(self):
        surface = coppice.mesh(make_fork(), levels=2)
        again = coppice.Surface.from_arrays(surface.positions, surface.quads)
        np.testing.assert_array_equal(again.quads, surface.quads)
        np.testing.assert_allclose(again.normals(), surface.normals(), atol=0.2)
        self.assertTrue(coppice.check(again, skeleton=make_fork()).passed)

    def test_leaves(self):
        tree = coppice.Skeleton.from_arrays(*FORK)
        surface = coppice.leaves(tree, species="oak", max_radius=1)
        leaves = surface.instances
        self.assertGreater(len(leaves), 10)
        self.assertEqual(leaves.rotations.shape, (len(leaves), 4))
        np.testing.assert_allclose(np.linalg.norm(leaves.rotations, axis=1), 1, atol=1e-3)
        self.assertLess(leaves.indices.max(), len(leaves.prototypes))
        part = leaves.prototypes[0]
        self.assertEqual(part.surface.uv.shape[1], 2)
        self.assertGreater(len(part.surface), 0)
        self.assertIsNone(coppice.mesh(tree, levels=1).instances)
        with tempfile.TemporaryDirectory() as folder:
            bare, full = os.path.join(folder, "bare.obj"), os.path.join(folder, "full.obj")
            surface.write(full)
            coppice.mesh(tree).write(bare)
            self.assertGreater(os.path.getsize(full), os.path.getsize(bare))

    def test_points(self):
        points = coppice.scan(coppice.mesh(make_fork(), levels=2))
        self.assertEqual(points.positions.shape, (len(points), 3))
        again = coppice.Points.from_arrays(points.positions)
        np.testing.assert_array_equal(again.positions, points.positions)
        self.assertEqual(again.attributes, {})


class Commands(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def test_files(self):
        tree = make_fork()
        for name in ("tree.swc", "tree.json", "tree.ply"):
            tree.write(self.path(name))
            np.testing.assert_array_equal(coppice.Skeleton.read(self.path(name)).radii, tree.radii)
        coppice.Skeleton.from_swc(self.path("tree.swc"))
        surface = coppice.mesh(self.path("tree.swc"), levels=1)
        surface.write(pathlib.Path(self.path("tree.ply")))
        np.testing.assert_array_equal(coppice.Surface.read(self.path("tree.ply")).quads, surface.quads)
        result = coppice.mesh(tree, output=[self.path("a.glb"), self.path("a.obj")])
        self.assertTrue(os.path.exists(self.path("a.glb")) and result.passed)
        self.assertIn("quads", result.report["counts"])
        with self.assertRaisesRegex(coppice.UsageError, "is a mesh, and"):
            coppice.Skeleton.read(self.path("a.glb"))

    def test_figures(self):
        tree = make_fork()
        figures = coppice.info(tree)
        self.assertEqual(figures["nodes"], 4)
        check = coppice.check(coppice.mesh(tree, levels=2), skeleton=tree)
        self.assertTrue(check.passed and check["watertight"])
        cut = coppice.mesh(tree, levels=2)
        opened = coppice.Surface.from_arrays(cut.positions, cut.quads[5:])
        check = coppice.check(opened)
        self.assertFalse(check.passed or check["watertight"])

    def test_images(self):
        image = coppice.render(make_fork(), width=64, height=64, samples=1)
        self.assertTrue(bytes(image).startswith(b"\x89PNG"))
        image.write(self.path("a.png"))
        self.assertTrue(make_fork()._repr_png_().startswith(b"\x89PNG"))

    def test_growth(self):
        tree = coppice.sprout(seasons=4)
        self.assertIsInstance(tree, coppice.Skeleton)
        scene = coppice.Scene("sphere crown center=0,0,2 radius=1\npointset generate crown count=300\ngrow tree crown\n")
        grown = coppice.grow(scene)
        self.assertGreater(len(grown), 10)

    def test_extraction(self):
        surface = coppice.mesh(make_fork(), levels=2)
        tree = coppice.extract(surface)
        self.assertIsInstance(tree, coppice.Skeleton)
        # The fork has two tips.
        self.assertEqual(coppice.info(tree)["tips"], 2)

    def test_editing(self):
        self.assertLess(len(coppice.edit(make_fork(), "prune 2")), 5)

    def test_words(self):
        self.assertIn("oak", coppice.run_words("species"))
        self.assertIn("mesh", coppice.commands())
        self.assertNotIn("studio", coppice.commands())
        self.assertTrue(coppice.__version__[0].isdigit())

    def test_signatures(self):
        signature = inspect.signature(coppice.mesh)
        self.assertEqual(signature.parameters["levels"].default, 2)
        self.assertIn("Number of subdivisions", coppice.mesh.__doc__)
        for name in coppice.commands():
            inspect.signature(getattr(coppice, name))
        # Angles are degrees, as on the command line.
        angle = inspect.signature(coppice.sprout).parameters["branching_angle"].default
        self.assertEqual(angle, 45)


class Errors(unittest.TestCase):
    def test_sentences(self):
        tree = make_fork()
        for call, error, text in [
            (lambda: coppice.mesh(tree, levels=9), coppice.UsageError, "--levels takes a whole number from 0 to 6"),
            (lambda: coppice.mesh(tree, levles=2), coppice.UsageError, "did you mean levels"),
            (lambda: coppice.mesh("no/such.swc"), coppice.FileError, "no/such.swc"),
            (lambda: coppice.check(tree), coppice.UsageError, "a mesh is needed here"),
            (lambda: coppice.mesh(tree, tree), coppice.UsageError, "takes 1 inputs, not 2"),
            (lambda: coppice.mesh(tree, units="mm"), coppice.UsageError, "do not apply to a skeleton in memory"),
            (lambda: coppice.Skeleton.from_arrays([[0, 0]], [1], [-1]), coppice.UsageError, "shape"),
            (lambda: coppice.Skeleton.from_arrays([[0, 0, float("nan")]], [1], [-1]), coppice.InputError, "node 0"),
            (lambda: coppice.Skeleton.from_arrays([[0, 0, 0]], [1], [0.5]), coppice.UsageError, "whole numbers"),
            (lambda: coppice.Surface.from_arrays([[0, 0, 0]], [[0, 1, 2]]), coppice.InputError, "the vertex 1"),
            (lambda: coppice.Scene(3), coppice.UsageError, "a scene is a text"),
        ]:
            with self.assertRaises(error) as raised:
                call()
            self.assertIn(text, str(raised.exception))
        with self.assertRaises(AttributeError):
            coppice.no_such_command

    def test_random_calls(self):
        """1,000 calls with an invalid argument each give an exception with one sentence."""
        from coppice import _commands

        rng = random.Random(7)
        tree = make_fork()
        surface = coppice.mesh(tree, levels=1)
        bad = {
            "bool": ["x", 7, None.__class__, [], 0.5],
            "int": ["x", "", float("nan"), float("inf"), [], {}, True, 1 << 80, tree, b"\0"],
            "float": ["x", "", float("nan"), float("inf"), [], True, -1e300, surface, object()],
            "choice": ["no such", "", 12, [], True, tree, "\0", "\ud800"],
            "place": ["x", [1, 2], 5, [1, 2, "x"], "1,2", [float("nan")] * 3],
            "file": [17, object(), "", b"no\0such", [tree], 1.5, {}],
        }
        names = list(_commands.commands())
        for _ in range(1000):
            command = _commands.commands()[rng.choice(names)]
            parameters = [p for p in command.parameters if p.option["type"] in bad and p.option["name"] not in _commands._LEFT_OUT]
            kind = rng.randrange(4)
            inputs, options = [], {}
            if kind == 0 or not parameters:
                options["no_" + rng.choice("abc") * rng.randrange(1, 9)] = 1
            elif kind == 1:
                inputs = [tree] * 9
            else:
                parameter = rng.choice(parameters)
                options[parameter.name] = rng.choice(bad[parameter.option["type"]])
            with self.subTest(command=command.name, inputs=len(inputs), options=options):
                with self.assertRaises(coppice.Error) as raised:
                    coppice.call(command.name, *inputs, progress=False, **options)
                self.assertGreater(len(str(raised.exception)), 10)
                self.assertNotIn("\n", str(raised.exception))
                self.assertNotIn("defect of coppice", str(raised.exception))


class Work(unittest.TestCase):
    def test_progress(self):
        seen = []
        coppice.mesh(make_fork(), progress=lambda stage, fraction: seen.append((stage, fraction)))
        self.assertIn("mesh", {stage for stage, _ in seen})
        self.assertTrue(all(0 <= fraction <= 1 for _, fraction in seen))
        with self.assertRaises(coppice.Cancelled):
            coppice.mesh(make_fork(), progress=lambda stage, fraction: False)

        def fail(stage, fraction):
            raise KeyError("mine")

        with self.assertRaises(KeyError):
            coppice.mesh(make_fork(), progress=fail)

    def test_ctrl_c(self):
        tree = make_large()
        coppice.mesh(make_fork())
        signal.signal(signal.SIGALRM, lambda *_: (_ for _ in ()).throw(KeyboardInterrupt()))
        self.addCleanup(signal.signal, signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        begin = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            coppice.mesh(tree, levels=4)
        self.assertLess(time.monotonic() - begin, 5)

    def test_threads(self):
        expected = coppice.mesh(make_fork(), levels=3).positions
        found = []
        threads = [
            threading.Thread(target=lambda: found.append(coppice.mesh(make_fork(), levels=3).positions))
            for _ in range(4)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(found), 4)
        for positions in found:
            np.testing.assert_array_equal(positions, expected)

    def test_import_is_light(self):
        code = "import time, sys; t = time.process_time(); import coppice; print(time.process_time() - t, 'numpy' in sys.modules)"
        runs = [subprocess.run([sys.executable, "-c", code], stdout=subprocess.PIPE, check=True) for _ in range(5)]
        outputs = [run.stdout.decode().split() for run in runs]
        self.assertEqual({words[1] for words in outputs}, {"False"})
        self.assertLess(min(float(words[0]) for words in outputs), 0.05)


class Others(unittest.TestCase):
    def test_networkx(self):
        module_or_skip("networkx")
        graph = make_fork().to_networkx()
        self.assertEqual(sorted(graph.edges), [(0, 1), (1, 2), (1, 3)])
        again = coppice.Skeleton.from_networkx(graph)
        np.testing.assert_array_equal(again.positions, make_fork().positions)
        with self.assertRaisesRegex(coppice.InputError, "no attribute"):
            coppice.Skeleton.from_networkx(graph, pos="place")

    def test_pandas(self):
        module_or_skip("pandas")
        table = make_fork().to_pandas()
        self.assertEqual(list(table.columns), ["node_id", "parent_id", "x", "y", "z", "radius"])
        again = coppice.Skeleton.from_pandas(table)
        np.testing.assert_array_equal(again.radii, make_fork().radii)
        with self.assertRaisesRegex(coppice.InputError, "no column radius"):
            coppice.Skeleton.from_pandas(table.drop(columns="radius"))

    def test_meshio(self):
        module_or_skip("meshio")
        surface = coppice.mesh(make_fork(), levels=1, attributes=True)
        mesh = surface.to_meshio()
        self.assertEqual(mesh.cells[0].type, "quad")
        self.assertEqual(len(mesh.cells[0].data), len(surface))
        self.assertIn("radius", mesh.point_data)

    def with_fake(self, name, **members):
        module = types.ModuleType(name)
        module.__dict__.update(members)
        sys.modules[name] = module
        self.addCleanup(sys.modules.pop, name)

    def test_fake_trimesh_pyvista_navis(self):
        surface = coppice.mesh(make_fork(), levels=1)
        self.with_fake("trimesh", Trimesh=lambda vertices, faces, process: (vertices, faces))
        vertices, faces = surface.to_trimesh()
        self.assertEqual((vertices.dtype, faces.dtype), (np.float64, np.int64))
        self.assertEqual(faces.shape, (2 * len(surface), 3))

        class PolyData:
            def __init__(self, points, faces):
                self.points, self.faces, self.point_data = points, faces, {}

        self.with_fake("pyvista", PolyData=PolyData)
        faces = surface.to_pyvista().faces.reshape(-1, 5)
        np.testing.assert_array_equal(faces[:, 0], 4)
        np.testing.assert_array_equal(faces[:, 1:], surface.quads)
        module_or_skip("pandas")
        self.with_fake("navis", TreeNeuron=lambda table, units: (table, units))
        table, units = make_fork().to_navis()
        self.assertEqual((len(table), units), (4, "m"))


if __name__ == "__main__":
    unittest.main()
