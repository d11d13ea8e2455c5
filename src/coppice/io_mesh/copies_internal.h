#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/io_mesh/instanced_parts.h"
#include "coppice/io_mesh/write_internal.h"

namespace coppice::io_internal {

/// Throws InvalidInput for invalid instances, for a material that does not exist, and for equal names of
/// prototypes or of materials, including those of the surface.
void check_parts(const InstancedParts& parts, std::span<const MaterialFiles> of_surface);

/// Returns the linear colour of a copy.
Vec3 compute_linear_color(std::array<std::uint8_t, 3> srgb);

/// A prototype with one vertex for every place of its texture, and copies of it, as one mesh.
class CopyMesh {
  public:
    /// Without `instances`, the mesh is the prototype itself. Tangents are computed on request.
    CopyMesh(const Prototype& prototype, const Instances* instances, std::span<const std::uint32_t> copies,
             bool has_tangents, const Context& ctx);
    CopyMesh(const CopyMesh&) = delete;
    CopyMesh& operator=(const CopyMesh&) = delete;
    ~CopyMesh() = default;

    const Prototype& prototype() const { return prototype_; }
    std::span<const std::uint32_t> copies() const { return copies_; }
    std::size_t vertex_count() const { return count_ * view().positions.size(); }
    std::size_t triangle_count() const { return count_ * view().face_count; }
    bool has_texture() const { return split_.has_value(); }
    bool has_tangents() const { return !tangents_.empty(); }
    bool is_merged() const { return instances_ != nullptr; }

    Vec3 position(std::size_t v) const;                      ///< [m] relative to the origin
    Vec3 normal(std::size_t v) const;                        ///< unit
    Tangent tangent(std::size_t v) const;                    ///< if there are some
    TexturePoint texture(std::size_t v) const;               ///< if there are some
    std::array<std::uint8_t, 3> color(std::size_t v) const;  ///< sRGB of the copy
    Triangle triangle(std::size_t f) const;                  ///< of `vertex_count()` vertices
    /// Returns the box of the positions after `convert`. In parallel.
    template <class Convert>
    Box3 find_box(const Context& ctx, const Convert& convert) const {
        constexpr std::size_t kGrain = 65536;
        const auto box_of_range = [&](IndexRange range) {
            Box3 box;
            for (std::size_t v = range.begin; v < range.end; ++v) box.extend(convert(position(v)));
            return box;
        };
        return parallel_reduce(ctx, vertex_count(), kGrain, Box3{}, box_of_range, [](Box3 a, const Box3& b) {
            a.extend(b);
            return a;
        });
    }

  private:
    const MeshView& view() const { return split_ ? split_->view : given_; }
    Vec3 turned(std::size_t v, Vec3 direction) const;

    const Prototype& prototype_;
    const Instances* instances_;
    std::span<const std::uint32_t> copies_;
    std::size_t count_;
    MeshView given_;
    std::optional<SplitMesh> split_;
    std::vector<Vec3> normals_;
    std::vector<Tangent> tangents_;
};

/// The meshes of all prototypes that have copies: of merged copies, or of the prototypes themselves.
struct CopyMeshes {
    CopyMeshes(const InstancedParts& parts, bool for_tangents, const Context& ctx);

    CompressedRows<std::uint32_t> copies;  ///< by prototype
    std::deque<CopyMesh> meshes;
};

/// A surface together with merged copies, for formats with one mesh.
struct SurfaceWithCopies {
    /// Copies the surface, with its texture coordinates, attributes and materials, and adds the copies.
    /// Attributes are -1 there.
    SurfaceWithCopies(const MeshView& surface, const InstancedParts& parts, const Context& ctx);

    PolygonMesh mesh;
    std::vector<VertexAttribute> attributes;
    std::vector<MaterialFiles> materials;  ///< those of the surface, or a plain one, then those of the copies
    std::vector<std::uint32_t> face_materials;
    std::vector<NamedGroup> groups;  ///< the surface and each prototype with copies

  private:
    void add_texture(const MeshView& surface, const MergedInstances& merged);
    void add_materials(const MeshView& surface, const MergedInstances& merged, const InstancedParts& parts);
};

/// Writes the copies in the prim "tree" of a USDA file.
void write_usda_copies(AtomicFile& file, const MeshView& surface, const Context& ctx);

}  // namespace coppice::io_internal
