#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/implicit/shape/curve.h"
#include "coppice/implicit/shape/profile.h"
#include "coppice/implicit/solid/solid.h"
#include "coppice/io/skeleton/node_attribute.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_set.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// What a name in a scene may stand for. Every kind has names of its own: a crown, the points in it and the
/// tree that grows into them may have the same one.
enum class ObjectKind { solid, path, profile, points, skeleton, mesh };

template <>
struct EnumNames<ObjectKind> {
    static constexpr std::array<std::string_view, 6> names{"solid",  "path",     "profile",
                                                           "points", "skeleton", "mesh"};
};

/// "a solid", "points"
std::string with_article(ObjectKind kind);

/// A surface as it was made or read.
struct Surface {
    std::variant<QuadMesh, TriMesh, PolygonMesh> mesh;  ///< as it came
};
/// The surface as faces of any number of corners.
PolygonMesh polygons_of(const Surface& surface);
/// The surface as triangles.
TriMesh triangles_of(const Surface& surface);
/// Number of faces.
std::uint64_t face_count(const Surface& surface);

/// An object of a scene; it never changes once it was made.
struct SceneObject {
    std::variant<Solid, Curve, Profile, PointSet, Skeleton, Surface> value;  ///< in the order of ObjectKind
    std::uint64_t bytes = 0;                                                 ///< of memory, about
    std::vector<NodeAttribute> attributes = {};  ///< of a skeleton's nodes, as its file had them

    ObjectKind kind() const { return static_cast<ObjectKind>(value.index()); }  ///< of the value
};
using ObjectPtr = std::shared_ptr<const SceneObject>;  ///< shared by all states that hold it

/// Bytes of memory, about; a solid made of others counts what is its own.
std::uint64_t memory_of(const PointSet& points);
/// Bytes of memory, about.
std::uint64_t memory_of(const Skeleton& skeleton, std::span<const NodeAttribute> attributes = {});
/// Bytes of memory, about.
std::uint64_t memory_of(const Surface& surface);

/// The figures of an object, a line each.
std::string description_of(const SceneObject& object);

}  // namespace coppice
