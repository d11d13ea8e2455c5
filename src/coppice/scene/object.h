#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/implicit/shape/curve.h"
#include "coppice/implicit/shape/profile.h"
#include "coppice/implicit/solid/solid.h"
#include "coppice/io_skeleton/node_attribute.h"
#include "coppice/mesh/mesh.h"
#include "coppice/pipeline/surface_verdict.h"
#include "coppice/points/point_set.h"
#include "coppice/scene/surface_leaves.h"
#include "coppice/scene/surface_material.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Kind of an object in a scene. Every kind has its own namespace: a crown, the points in it and the tree
/// that grows into them may have the same name.
enum class ObjectKind { solid, path, profile, points, skeleton, mesh, material };

template <>
struct EnumNames<ObjectKind> {
    static constexpr std::array<std::string_view, 7> names{"solid",    "path", "profile", "points",
                                                           "skeleton", "mesh", "material"};
};

/// "a solid", "points"
std::string with_article(ObjectKind kind);

/// A surface as it was created or read.
struct Surface {
    std::variant<QuadMesh, TriMesh, PolygonMesh> mesh;  ///< in the original representation
    Buffer<TexturePoint> texture =
        {};  ///< per corner; empty if there are no coordinates, or polygons hold them
    Buffer<TextureBlend> texture_blends = {};  ///< the second set; per corner, or empty
    /// By material slot, of surfaces with texture coordinates; those of slots without one are empty. None for
    /// surfaces without materials.
    std::vector<SurfaceMaterial> materials = {};
    std::vector<std::uint32_t> slots =
        {};  ///< per face: its MaterialSlot as a number; empty: all faces are bark
    std::shared_ptr<const SurfaceLeaves> leaves = {};  ///< null without leaves
    /// Comparison with the skeleton, if SceneSettings::judge requests it and the surface can be judged.
    std::shared_ptr<const SurfaceVerdict> verdict = {};
};
/// Returns the surface as polygons.
PolygonMesh make_polygons(const Surface& surface);
/// Returns the surface as triangles.
TriMesh to_triangles(const Surface& surface);
/// Returns the number of faces.
std::uint64_t face_count(const Surface& surface);

/// An immutable object of a scene.
struct SceneObject {
    /// in the order of ObjectKind
    std::variant<Solid, Curve, Profile, PointSet, Skeleton, Surface, SurfaceMaterial> value;
    std::uint64_t bytes = 0;  ///< approximate memory
    /// attributes of the nodes of a skeleton, as read from its file
    std::vector<NodeAttribute> attributes = {};

    ObjectKind kind() const { return static_cast<ObjectKind>(value.index()); }  ///< kind of the value
};
using ObjectPtr = std::shared_ptr<const SceneObject>;  ///< shared by all states that contain it

/// Returns the approximate memory [bytes]; a solid made of others counts only its own.
std::uint64_t compute_memory(const PointSet& points);
/// Returns the approximate memory [bytes].
std::uint64_t compute_memory(const Skeleton& skeleton, std::span<const NodeAttribute> attributes = {});
/// Returns the approximate memory [bytes].
std::uint64_t compute_memory(const Surface& surface);

/// Returns the figures of an object, one per line.
std::string describe_object(const SceneObject& object);

}  // namespace coppice
