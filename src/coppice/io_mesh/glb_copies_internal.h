#pragma once

#include <array>
#include <vector>

#include "coppice/io_mesh/copies_internal.h"
#include "coppice/io_mesh/glb_materials_internal.h"

namespace coppice::io_internal {

/// The copies of a GLB file: a node for each prototype that has some, with EXT_mesh_gpu_instancing or with
/// all copies merged.
class GlbCopies : public GlbMotionPart {
  public:
    GlbCopies(const InstancedParts& parts, const Context& ctx)
        : parts_(parts), instances_(*parts.instances), meshes_(parts, true, ctx), ctx_(ctx) {}

    void lay_out(const GlbVertices& vertices, nlohmann::json& primitive, GlbLayout& layout) override;
    void describe(nlohmann::json& file) const override;
    void write(AtomicFile& file, const GlbVertices& vertices, const Context& ctx) override;

  private:
    /// Attributes of the copies of a prototype that differ from the default.
    struct Varied {
        bool scales = false, colors = false;
    };
    /// The accessors of a prototype.
    struct Accessors {
        nlohmann::json attributes, instancing;
        std::size_t indices = 0;
        Varied varied;
    };

    Varied find_varied(const CopyMesh& mesh) const;
    Accessors lay_out(const CopyMesh& mesh, GlbLayout& layout) const;
    void write_mesh(AtomicFile& file, const CopyMesh& mesh, const Context& ctx) const;
    void write_copies(AtomicFile& file, const CopyMesh& mesh, Varied varied, const Context& ctx) const;

    const InstancedParts& parts_;
    const Instances& instances_;
    CopyMeshes meshes_;
    GlbMaterials materials_;
    std::vector<Accessors> accessors_;  ///< of the meshes
    Context ctx_;
};

}  // namespace coppice::io_internal
