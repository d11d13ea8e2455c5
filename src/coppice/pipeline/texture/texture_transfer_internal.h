#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/pipeline/texture/tube_texture_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::pipeline_internal {

/// Bark coordinates at a point.
struct BarkPoint {
    std::uint32_t axis = kNoIndex;  ///< the branch; kNoIndex: there is none
    std::uint32_t wraps = 1;        ///< number of times that the texture is repeated around it
    float turns = 0;                ///< around the branch, from an arbitrary beginning
    float v = 0;                    ///< along the branch
    float tiles_per_metre = 1;      ///< around it
    Vec3 along{0, 0, 1};            ///< direction in which v increases
    std::uint32_t zone = kNoIndex;  ///< of its second set, as in TexturePatch
    NodeId tube;                    ///< the tube, as in TexturePatch
    float share = 0;                ///< of the length of the tube
};

/// Finds bark coordinates for faces that are not quads of a tube: those of the closest refined quad of a
/// tube, at the closest point of its plane.
class TextureTransfer {
  public:
    /// The arguments must outlive this object. Uses the quads of the tubes that are marked. O(quads).
    TextureTransfer(const QuadBuild& build, const TubeTexture& texture, std::span<const std::uint8_t> tubes,
                    const Context& ctx);

    bool empty() const { return quads_.empty(); }  ///< whether there are no quads
    /// Returns the index of the closest quad; kNoIndex if there is none. `near`: a quad at which the search
    /// begins, or kNoIndex; one near the point makes it faster and does not change the result. If given, on
    /// this branch. O(log n).
    std::uint32_t find_nearest(Vec3d p, std::uint32_t near, std::uint32_t axis = kNoIndex) const;
    /// Returns the coordinates for a point near a quad of find_nearest().
    BarkPoint evaluate(std::uint32_t nearest, Vec3 p) const;

  private:
    // A refined quad with texture.
    struct CarrierQuad {
        std::uint32_t cage_quad, column, row;
    };
    std::vector<CarrierQuad> find_quads(std::span<const std::uint8_t> tubes) const;
    std::array<Vec3, 4> corners(const CarrierQuad& q) const;
    std::vector<Box3> boxes() const;
    double squared_distance(std::uint32_t quad, Vec3d p) const;

    const QuadBuild& build_;
    const TubeTexture& texture_;
    std::vector<CarrierQuad> quads_;
    BoxTree tree_;
};

}  // namespace coppice::pipeline_internal
