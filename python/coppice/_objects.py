"""Skeletons, surfaces, points, images and scenes: objects of the library with arrays as views of its memory."""

from __future__ import annotations

import ctypes
import os
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Tuple, Union

from . import _library as c
from ._errors import InputError, UsageError
from ._task import Task

if TYPE_CHECKING:
    import numpy as np

Path = Union[str, "os.PathLike[str]"]


def _address(array: Any) -> int:
    return int(array.ctypes.data)


def _matrix(values: Any, columns: int, name: str) -> Any:
    """Returns numbers as a matrix of doubles."""
    import numpy

    try:
        out = numpy.ascontiguousarray(values, numpy.float64)
    except (TypeError, ValueError):
        raise UsageError("%s must be numbers" % name) from None
    if out.ndim != 2 or out.shape[1] != columns:
        raise UsageError("%s must be an array of shape (n, %d), not %s" % (name, columns, out.shape))
    return out


def _vector(values: Any, kind: str, count: int, name: str) -> Any:
    """Returns numbers as a vector of this length."""
    import numpy

    try:
        given = numpy.asarray(values)
        out = numpy.ascontiguousarray(given, kind)
        exact = given.dtype.kind in "iufb" and (kind == "f8" or given.dtype.kind in "iub" or (out == given).all())
    except (TypeError, ValueError, OverflowError):
        exact = False
    if not exact:
        raise UsageError("%s must be %s" % (name, "numbers" if kind == "f8" else "whole numbers"))
    if out.shape != (count,):
        raise UsageError("%s must be an array of shape (%d,), not %s" % (name, count, out.shape))
    return out


class Object:
    """Base of the objects of the library, which are immutable."""

    _kind = -1
    _name = ""  #: name in memory, of which the extension selects the kind

    def __init__(self, handle: c.Handle, report: Optional[Dict[str, Any]] = None) -> None:
        self._handle = handle
        #: Report of the command that made the object: stages with seconds, counts, repairs and warnings.
        self.report: Dict[str, Any] = report or {}

    def _attribute_views(self, count: int) -> Dict[str, Any]:
        out = {}
        library = c.library()
        for index in range(library.attribute_count(self._handle.address)):
            name, values = ctypes.c_char_p(), ctypes.c_void_p()
            library.attribute_get(self._handle.address, index, ctypes.byref(name), ctypes.byref(values))
            out[(name.value or b"").decode()] = c.view(self._handle, values.value, (count,), "<f4")
        return out

    @classmethod
    def _read(cls, path: Path, options: Mapping[str, Any]) -> Any:
        from ._commands import call

        made = call("convert", path, output=cls._name, **options)
        if not isinstance(made, cls):
            raise InputError("%s: it is a %s, not a %s" % (os.fspath(path), type(made).__name__, cls.__name__))
        return made

    def write(self, path: Path, **options: Any) -> None:
        """Writes a file; its extension selects the format. The options are those of convert()."""
        from ._commands import call

        call("convert", self, output=path, **options)


class _Placed(Object):
    """Base of the objects with positions."""

    _structure: Any = None  #: of their arrays in C
    _function = ""  #: gets the arrays

    @property
    def _arrays(self) -> Any:
        arrays = self._structure()
        getattr(c.library(), self._function)(self._handle.address, ctypes.byref(arrays))
        return arrays

    @property
    def origin(self) -> Tuple[float, float, float]:
        """Added to the positions, so that georeferenced data keep their accuracy."""
        x, y, z = self._arrays.origin
        return x, y, z


class Skeleton(_Placed):
    """A forest of nodes with radii: trees, roots, vessels, neurons. Parents precede their children."""

    _kind = c.SKELETON
    _name = "memory:skeleton.json"
    _structure = c.SkeletonArrays
    _function = "skeleton_get"

    def __len__(self) -> int:
        return int(self._arrays.count)

    def __repr__(self) -> str:
        return "<coppice.Skeleton: %d nodes>" % len(self)

    @property
    def positions(self) -> "np.ndarray":
        """Positions of the nodes relative to the origin, (n, 3), without a copy."""
        arrays = self._arrays
        return c.view(self._handle, arrays.positions, (arrays.count, 3), "<f4")

    @property
    def radii(self) -> "np.ndarray":
        """Radii of the nodes, (n,), without a copy."""
        arrays = self._arrays
        return c.view(self._handle, arrays.radii, (arrays.count,), "<f4")

    @property
    def parents(self) -> "np.ndarray":
        """Index of the parent of each node, (n,), -1 for roots, without a copy."""
        arrays = self._arrays
        return c.view(self._handle, arrays.parents, (arrays.count,), "<i4")

    @property
    def units(self) -> str:
        """Unit of all lengths, "m" by default."""
        return str(self._arrays.units.decode())

    @property
    def attributes(self) -> Dict[str, "np.ndarray"]:
        """Further values of the nodes by name, such as those of an extraction, without a copy."""
        return self._attribute_views(len(self))

    @property
    def nodes(self) -> "np.ndarray":
        """The nodes as a structured array: position with the origin added, radius and parent."""
        import numpy

        out = numpy.empty(len(self), [("position", "<f8", (3,)), ("radius", "<f4"), ("parent", "<i4")])
        out["position"] = self.positions + numpy.array(self.origin)
        out["radius"] = self.radii
        out["parent"] = self.parents
        return out

    @classmethod
    def read(cls, path: Path, **options: Any) -> "Skeleton":
        """Reads a skeleton or cylinder file of any format; the options are those of convert()."""
        made: Skeleton = cls._read(path, options)
        return made

    @classmethod
    def from_swc(cls, path: Path, **options: Any) -> "Skeleton":
        """Reads an SWC file."""
        return cls.read(path, format="swc", **options)

    @classmethod
    def from_arrays(cls, positions: Any, radii: Any, parents: Any, ids: Any = None) -> "Skeleton":
        """Makes a skeleton of nodes in any order, and repairs it as files are (see report["repairs"]).

        positions: (n, 3); radii: (n,), unknown ones are 0 or NaN; parents: (n,), the ids of the parents, -1 for
        roots; ids: (n,), by default 0, 1, 2, ...
        """
        places = _matrix(positions, 3, "positions")
        count = len(places)
        sizes = _vector(radii, "f8", count, "radii")
        links = _vector(parents, "i8", count, "parents")
        names = None if ids is None else _vector(ids, "i8", count, "ids")
        nodes = c.Nodes(
            count, _address(places), _address(sizes), None if names is None else _address(names), _address(links)
        )
        task = Task()
        handle = task.make("skeleton_create", ctypes.byref(nodes))
        return cls(handle, task.report)

    @classmethod
    def from_networkx(cls, graph: Any, pos: str = "pos", radius: str = "radius") -> "Skeleton":
        """Makes a skeleton of a directed graph of networkx with edges from parents to children; the attributes of
        the nodes contain their position and radius."""
        index = {node: i for i, node in enumerate(graph.nodes)}
        parents = [-1] * len(index)
        for parent, child in graph.edges:
            if parents[index[child]] != -1:
                raise InputError("the node %r has two parents; a skeleton is a forest" % (child,))
            parents[index[child]] = index[parent]
        try:
            places = [graph.nodes[node][pos] for node in index]
            sizes = [graph.nodes[node].get(radius, 0) for node in index]
        except KeyError as error:
            raise InputError("a node has no attribute %s; name the attribute by pos=" % error) from None
        return cls.from_arrays(places, sizes, parents)

    @classmethod
    def from_pandas(cls, table: Any) -> "Skeleton":
        """Makes a skeleton of a table with the columns node_id, parent_id, x, y, z and radius, as of navis."""
        missing = [name for name in ("node_id", "parent_id", "x", "y", "z", "radius") if name not in table]
        if missing:
            raise InputError("the table has no column %s" % missing[0])
        ids, parents = table["node_id"].to_numpy(), table["parent_id"].to_numpy()
        return cls.from_arrays(table[["x", "y", "z"]].to_numpy(), table["radius"].to_numpy(), parents, ids)

    def to_networkx(self) -> Any:
        """Returns a networkx.DiGraph with edges from parents to children, and pos and radius of the nodes."""
        import networkx

        graph = networkx.DiGraph()
        for i, node in enumerate(self.nodes):
            graph.add_node(i, pos=tuple(float(x) for x in node["position"]), radius=float(node["radius"]))
        graph.add_edges_from((int(p), i) for i, p in enumerate(self.parents) if p >= 0)
        return graph

    def to_pandas(self) -> Any:
        """Returns a pandas.DataFrame with node_id, parent_id, x, y, z, radius and the attributes."""
        import pandas

        nodes = self.nodes
        x, y, z = nodes["position"].T
        columns: Dict[str, Any] = {"node_id": range(len(nodes)), "parent_id": nodes["parent"], "x": x, "y": y, "z": z}
        return pandas.DataFrame({**columns, "radius": nodes["radius"], **self.attributes})

    def to_navis(self) -> Any:
        """Returns a navis.TreeNeuron."""
        import navis

        return navis.TreeNeuron(self.to_pandas(), units=self.units)

    def _repr_png_(self) -> bytes:
        from ._commands import call

        return bytes(call("render", self, width=480, height=480, samples=16, progress=False))


class Surface(_Placed):
    """Vertices and faces. Faces are counter-clockwise seen from outside."""

    _kind = c.SURFACE
    _name = "memory:surface.glb"
    _structure = c.SurfaceArrays
    _function = "surface_get"

    def __len__(self) -> int:
        return int(self._arrays.face_count)

    def __repr__(self) -> str:
        arrays = self._arrays
        return "<coppice.Surface: %d vertices, %d faces>" % (arrays.vertex_count, arrays.face_count)

    @property
    def positions(self) -> "np.ndarray":
        """Positions of the vertices relative to the origin, (n, 3), without a copy."""
        arrays = self._arrays
        return c.view(self._handle, arrays.positions, (arrays.vertex_count, 3), "<f4")

    @property
    def corners(self) -> "np.ndarray":
        """Vertices of the corners of all faces, face by face, without a copy."""
        arrays = self._arrays
        return c.view(self._handle, arrays.corners, (arrays.corner_count,), "<u4")

    @property
    def face_starts(self) -> "np.ndarray":
        """First corner of each face, and the number of corners: (m + 1,)."""
        import numpy

        arrays = self._arrays
        if arrays.first:
            return c.view(self._handle, arrays.first, (arrays.face_count + 1,), "<u4")
        return numpy.arange(0, arrays.corner_count + 1, arrays.face_size or 1, dtype="<u4")

    @property
    def faces(self) -> "np.ndarray":
        """Vertices of the faces, (m, 3) or (m, 4), without a copy. Raises InputError if faces differ in their number
        of corners; see corners and face_starts."""
        arrays = self._arrays
        if arrays.face_size == 0 and arrays.face_count > 0:
            raise InputError("the faces have different numbers of corners; use corners and face_starts, or triangles()")
        return c.view(self._handle, arrays.corners, (arrays.face_count, arrays.face_size or 4), "<u4")

    @property
    def quads(self) -> "np.ndarray":
        """Vertices of the faces, (m, 4), without a copy. Raises InputError for other faces than quads."""
        arrays = self._arrays
        if arrays.face_size != 4 and arrays.face_count > 0:
            raise InputError("the faces are not quads; use faces or triangles()")
        return self.faces

    def triangles(self) -> "np.ndarray":
        """Vertices of triangles, (k, 3): faces are split from their first corner."""
        import numpy

        if self._arrays.face_size == 3:
            return self.faces
        starts = self.face_starts.astype(numpy.int64)
        sizes = numpy.diff(starts)
        corners, parts = self.corners, []
        for k in range(1, int(sizes.max(initial=2)) - 1):
            first = starts[:-1][sizes > k + 1]
            parts.append(numpy.stack([corners[first], corners[first + k], corners[first + k + 1]], axis=1))
        return numpy.concatenate(parts) if parts else numpy.zeros((0, 3), "<u4")

    @property
    def uv(self) -> Optional["np.ndarray"]:
        """Texture coordinates of the corners, (number of corners, 2), without a copy; None if there are none."""
        arrays = self._arrays
        return c.view(self._handle, arrays.texture, (arrays.corner_count, 2), "<f4") if arrays.texture else None

    @property
    def material_slots(self) -> Optional["np.ndarray"]:
        """Material of each face: 0 bark, 1 twig, 2 cut; without a copy. None if all are bark."""
        arrays = self._arrays
        return c.view(self._handle, arrays.material_slots, (arrays.face_count,), "<u4")

    @property
    def attributes(self) -> Dict[str, "np.ndarray"]:
        """Values of the vertices by name, as made by mesh(..., attributes=True), without a copy."""
        return self._attribute_views(self._arrays.vertex_count)

    @property
    def instances(self) -> Optional[Instances]:
        """Leaves of the surface, as made by tree() and leaves(); None if there are none."""
        arrays = c.InstancesArrays()
        c.library().instances_get(self._handle.address, ctypes.byref(arrays))
        return Instances(self._handle, arrays) if arrays.count > 0 else None

    def normals(self) -> "np.ndarray":
        """Computes the unit normals of the vertices, (n, 3), weighted by area."""
        import numpy

        out = numpy.empty((self._arrays.vertex_count, 3), numpy.float32)
        Task().check(c.library().surface_normals(self._handle.address, _address(out)))
        return out

    @classmethod
    def read(cls, path: Path, **options: Any) -> "Surface":
        """Reads a surface of any format; the options are those of convert()."""
        made: Surface = cls._read(path, options)
        return made

    @classmethod
    def from_arrays(cls, positions: Any, faces: Any) -> "Surface":
        """Makes a surface of positions, (n, 3), and faces, (m, k) with k >= 3."""
        import numpy

        places = _matrix(positions, 3, "positions")
        given = numpy.asarray(faces)
        if given.ndim != 2:
            raise UsageError("faces must be an array of shape (m, k), not %s" % (given.shape,))
        corners = _vector(given.reshape(-1), "i8", given.size, "faces")
        made = c.Faces(len(places), _address(places), given.shape[0], given.shape[1], _address(corners))
        return cls(Task().make("surface_create", ctypes.byref(made)))

    def to_trimesh(self) -> Any:
        """Returns a trimesh.Trimesh of triangles."""
        import numpy
        import trimesh

        places = self.positions + numpy.array(self.origin)
        return trimesh.Trimesh(places, self.triangles().astype(numpy.int64), process=False)

    def to_pyvista(self) -> Any:
        """Returns a pyvista.PolyData with the attributes as point data."""
        import numpy
        import pyvista

        starts = self.face_starts.astype(numpy.int64)
        counted = numpy.insert(self.corners.astype(numpy.int64), starts[:-1], numpy.diff(starts))
        out = pyvista.PolyData(self.positions + numpy.array(self.origin), counted)
        for name, values in self.attributes.items():
            out.point_data[name] = values
        return out

    def to_meshio(self) -> Any:
        """Returns a meshio.Mesh with the attributes as point data."""
        import meshio
        import numpy

        kinds = {3: "triangle", 4: "quad"}
        size = self._arrays.face_size
        cells: List[Tuple[str, Any]] = (
            [(kinds[size], self.faces)] if size in kinds else [("triangle", self.triangles())]
        )
        return meshio.Mesh(self.positions + numpy.array(self.origin), cells, point_data=dict(self.attributes))

    def _repr_png_(self) -> bytes:
        from ._commands import call

        return bytes(call("render", self, width=480, height=480, samples=16, progress=False))


class Prototype:
    """A mesh that is placed many times, such as a leaf: its origin is the point of attachment, its length extends
    along +y, and its upper side faces +z."""

    def __init__(self, surface: c.Handle, index: int) -> None:
        made = c.Prototype()
        Task().check(c.library().prototype_get(surface.address, index, ctypes.byref(made)))
        #: Name for files, such as "leaf_1".
        self.name = str(made.name.decode())
        #: Triangles with texture coordinates.
        self.surface = Surface(c.Handle(made.mesh))
        #: Linear colour, multiplied with that of the image.
        self.color: Tuple[float, float, float] = tuple(made.color)
        #: The image as PNG; None if there is none.
        self.image: Optional[bytes] = ctypes.string_at(made.image, made.image_size) if made.image else None

    def __repr__(self) -> str:
        return "<coppice.Prototype: %s, %d faces>" % (self.name, len(self.surface))


class Instances:
    """The placed copies of a surface, such as leaves, without a copy of their arrays."""

    def __init__(self, surface: c.Handle, arrays: c.InstancesArrays) -> None:
        count = arrays.count
        #: The meshes that are placed.
        self.prototypes: List[Prototype] = [Prototype(surface, i) for i in range(arrays.prototype_count)]
        #: Index of the mesh of each copy, (n,).
        self.indices: "np.ndarray" = c.view(surface, arrays.prototypes, (count,), "<u4")
        #: Positions of the points of attachment relative to the origin, (n, 3).
        self.positions: "np.ndarray" = c.view(surface, arrays.positions, (count, 3), "<f4")
        #: Unit quaternions x, y, z, w, (n, 4).
        self.rotations: "np.ndarray" = c.view(surface, arrays.rotations, (count, 4), "<f4")
        #: Scales, (n,).
        self.scales: "np.ndarray" = c.view(surface, arrays.scales, (count,), "<f4")
        #: Colours in sRGB, (n, 3), multiplied with that of the mesh.
        self.colors: "np.ndarray" = c.view(surface, arrays.colors, (count, 3), "|u1")
        #: Added to the positions.
        self.origin: Tuple[float, float, float] = tuple(arrays.origin)

    def __len__(self) -> int:
        return len(self.positions)

    def __repr__(self) -> str:
        return "<coppice.Instances: %d copies of %d meshes>" % (len(self), len(self.prototypes))


class Points(_Placed):
    """Points of a scan, with attributes."""

    _kind = c.POINTS
    _name = "memory:points.las"
    _structure = c.PointsArrays
    _function = "points_get"

    def __len__(self) -> int:
        return int(self._arrays.count)

    def __repr__(self) -> str:
        return "<coppice.Points: %d points>" % len(self)

    @property
    def positions(self) -> "np.ndarray":
        """Positions relative to the origin, (n, 3), without a copy."""
        arrays = self._arrays
        return c.view(self._handle, arrays.positions, (arrays.count, 3), "<f4")

    @property
    def attributes(self) -> Dict[str, "np.ndarray"]:
        """intensities, classes, colors and tree_ids as far as they are known, without a copy."""
        arrays = self._arrays
        count = arrays.count
        views = {
            "intensities": c.view(self._handle, arrays.intensities, (count,), "<f4"),
            "classes": c.view(self._handle, arrays.classes, (count,), "|u1"),
            "colors": c.view(self._handle, arrays.colors, (count, 3), "|u1"),
            "tree_ids": c.view(self._handle, arrays.tree_ids, (count,), "<u4"),
        }
        return {name: values for name, values in views.items() if values is not None}

    @classmethod
    def read(cls, path: Path, **options: Any) -> "Points":
        """Reads points of any format; the options are those of convert()."""
        made: Points = cls._read(path, options)
        return made

    @classmethod
    def from_arrays(cls, positions: Any) -> "Points":
        """Makes points of positions, (n, 3)."""
        places = _matrix(positions, 3, "positions")
        return cls(Task().make("points_create", len(places), _address(places)))


class _Bytes(Object):
    _kind = c.BYTES

    def __bytes__(self) -> bytes:
        start, count = ctypes.c_void_p(), ctypes.c_size_t()
        c.library().bytes_get(self._handle.address, ctypes.byref(start), ctypes.byref(count))
        return ctypes.string_at(start, count.value)


class Image(_Bytes):
    """An image as PNG; bytes(image) are those of the file."""

    _name = "memory:image.png"

    def __repr__(self) -> str:
        return "<coppice.Image: %d bytes of PNG>" % len(bytes(self))

    def write(self, path: Path, **options: Any) -> None:
        """Writes the PNG file."""
        if options:
            raise UsageError("images have no options for writing")
        with open(path, "wb") as file:
            file.write(bytes(self))

    def _repr_png_(self) -> bytes:
        return bytes(self)


class Scene(_Bytes):
    """The text of a scene, for run(), grow() and tree()."""

    _name = "memory:scene.coppice"

    def __init__(self, text: str) -> None:
        try:
            encoded = text.encode()
        except (AttributeError, UnicodeEncodeError):
            raise UsageError("a scene is a text of commands, one per line") from None
        super().__init__(Task().make("bytes_create", encoded, len(encoded)))

    def __repr__(self) -> str:
        return "<coppice.Scene: %d bytes>" % len(bytes(self))


def wrap(handle: c.Handle, report: Dict[str, Any]) -> Object:
    """Returns the object of a handle."""
    kinds = {c.SKELETON: Skeleton, c.SURFACE: Surface, c.POINTS: Points, c.BYTES: Image}
    made: Object = kinds[handle.kind()](handle, report)
    return made
