#pragma once

#include "coppice/base/context.h"
#include "coppice/ramification/main_mesh_internal.h"

namespace coppice::ramification_internal {

/// Main mesh and stubs after one subdivision, in one mesh.
class Subdivided {
  public:
    Subdivided(const MainMesh& main, const Context& ctx);

    /// Separates every additional lateral from its stub and pastes it into its seat. Adds to the objective.
    ControlMesh paste(const Branches& branches, RamificationReport& report, const Context& ctx) &&;

  private:
    friend class Paster;
    const MainMesh& main_;
    Buffer<Vec3> positions_, anchors_;
    std::vector<Quad> quads_;
    std::vector<std::uint32_t> pasted_;  ///< per quad beyond those of the main mesh: its unit
    std::vector<std::array<std::uint32_t, 8>> boundary_;  ///< per paste: boundary of the lateral
};

}  // namespace coppice::ramification_internal
