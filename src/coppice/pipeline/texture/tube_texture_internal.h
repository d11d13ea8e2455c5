#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/pipeline/mesh_options.h"
#include "coppice/pipeline/quads/quad_build.h"
#include "coppice/pipeline/repair/tube_quads_internal.h"
#include "coppice/pipeline/repair/tube_rows_internal.h"
#include "coppice/pipeline/texture/blend_zone_internal.h"
#include "coppice/pipeline/texture/radii_beyond_internal.h"
#include "coppice/subdivision/kernel/patch_index.h"

namespace coppice::pipeline_internal {

/// Returns the refined quads that remeshing kept: of surfaces that are not coarsened, the first quads of the
/// mesh.
std::vector<std::uint32_t> find_kept_quads(const QuadBuild& build, const TubeRows& rows);

/// Texture coordinates on the refined quads of a cage quad: a rectangle around and along a branch.
struct TexturePatch {
    std::uint32_t axis = kNoIndex;     ///< the branch; kNoIndex: the cage quad is not a rectangle of a tube
    std::uint32_t wraps = 1;           ///< number of times that the texture is repeated around the branch
    float left = 0;                    ///< [turns] around the branch, at corners 0 and 3
    float right = 0;                   ///< [turns] at corners 1 and 2
    std::array<float, 4> v{};          ///< along the branch, at the corners
    std::uint32_t first_row = 0;       ///< index of the first of the rows of vertices
    float tiles_per_metre = 0;         ///< around the branch
    std::uint32_t zone = kNoIndex;     ///< of its second set; kNoIndex: there is none
    NodeId tube;                       ///< the tube with these coordinates
    std::array<float, 2> share{0, 1};  ///< of the length of the tube, at its first and its last row

    bool is_rectangle() const { return axis != kNoIndex; }
};

/// Texture coordinates at the columns of a patch.
struct PatchColumns {
    std::vector<float> u;            ///< per column
    std::vector<float> first, last;  ///< per column: v at the first and at the last row
};

/// Bark coordinates on the refined cage of a surface of quads. A branch begins at a root, or where it leaves
/// another one, and follows the leaders to a tip. Around it, u is the column of the cage times the number of
/// wraps, a whole number; along it, v increases by the mean length of the edges of a row over their
/// circumference, times the wraps, so that a square texture is not distorted. The number of wraps comes
/// closest to tiles of the given width, that of twigs for tubes of twigs, and changes along a branch only
/// where it would be wrong by a factor of more than the square root of 2. At forks, v increases only on the
/// side of the laterals; the difference around the stem decreases along the next tubes. Rows between a branch
/// and the face through which it leaves its parent continue it backwards. A second set continues the
/// coordinates of the stem into its laterals, and the number of wraps beyond the rings where it changes.
class TubeTexture {
  public:
    /// The build must outlive this object. Uses the width of a tile, whether there is a second set, and the
    /// tile and the diameter of twigs. O(refined vertices).
    TubeTexture(const QuadBuild& build, const TextureOptions& options, const SlotOptions& slots,
                const Context& ctx);

    const TubeRows& tube_rows() const { return tube_rows_; }
    const std::vector<TubeFaces>& faces() const { return faces_; }  ///< per tube
    const TexturePatch& patch(std::uint32_t cage_quad) const { return patch_[cage_quad]; }
    std::uint32_t size() const { return size_; }  ///< number of quads along the side of a cage quad

    /// Returns the refined vertex in a column and a row of a cage quad, both from 0 to size().
    std::uint32_t vertex(std::uint32_t cage_quad, std::uint32_t column, std::uint32_t row) const {
        return patch_vertex(cage_, size_, cage_quad, column, row);
    }
    /// Returns the turns at a column of a patch of vertices, from 0 to size().
    float turns(const TexturePatch& p, std::uint32_t column) const {
        return p.left + (p.right - p.left) * static_cast<float>(column) / static_cast<float>(size_);
    }
    /// Returns v at a column and a row of a patch of vertices, both from 0 to size().
    float v(const TexturePatch& p, std::uint32_t column, std::uint32_t row) const {
        const float share = static_cast<float>(column) / static_cast<float>(size_);
        return std::lerp(std::lerp(p.v[0], p.v[1], share), std::lerp(p.v[3], p.v[2], share),
                         rows_[p.first_row + row]);
    }
    /// Sets the coordinates at the columns of a patch.
    void set_columns(const TexturePatch& p, PatchColumns& out) const;
    /// Returns v as above, from the columns of the patch.
    float v(const TexturePatch& p, const PatchColumns& columns, std::uint32_t column,
            std::uint32_t row) const {
        return std::lerp(columns.first[column], columns.last[column], rows_[p.first_row + row]);
    }
    /// Returns the share of the length of its tube at a place along a patch, from 0 to size().
    float share(const TexturePatch& p, float row) const {
        return std::lerp(p.share[0], p.share[1], row / static_cast<float>(size_));
    }
    /// Returns the second set at a place of a zone; the first set, with weight 0, without a zone.
    TextureBlend blend(std::uint32_t zone, TexturePoint first) const;
    /// Returns the number of branches.
    std::uint32_t axis_count() const { return axis_count_; }

  private:
    // The texture of one tube.
    struct Tube {
        float circumference = 0;  // [m] mean of its rings
        float length = 0;         // [mean circumferences]
        std::uint32_t axis = kNoIndex;
        std::uint32_t wraps = 1;
        std::uint32_t column = 0;  // of its first cage quad
        float begin = 0, end = 0;  // mean v of its rings
        std::uint32_t zone = kNoIndex;
    };
    // A quad of the cage between a lateral and the face of the stem through which it leaves.
    struct Collar {
        std::uint32_t cage_quad;
        NodeId lateral;
        std::uint32_t edge;  // at which it joins the lateral's ring
        int end;             // of the lateral
    };
    using Ring = std::vector<std::uint32_t>;  // cage vertices around a tube
    // The edge k of a cage quad, from its corner k to the next one.
    struct Side {
        std::uint32_t cage_quad, k;
    };

    static float tiles_per_metre(const Tube& t) {
        return static_cast<float>(t.wraps) / std::max(t.circumference, 1e-30f);
    }
    static std::uint32_t find_edge(std::span<const std::uint32_t> ring, std::uint32_t a, std::uint32_t b);
    Tube& at(NodeId n) { return tube_[n.index()]; }
    const Tube& at(NodeId n) const { return tube_[n.index()]; }
    Vec3 position(std::uint32_t v) const { return build_.refined[v]; }
    Ring ring(NodeId tube, int end) const;
    void measure_rows(NodeId tube);
    float tile(NodeId tube) const;
    std::uint32_t choose_wraps(NodeId tube, std::uint32_t current) const;
    void follow_axes();
    void continue_axis(NodeId tube);
    void set_end(NodeId tube);
    // v at a vertex of the ring at an end of a tube.
    float& ring_v(NodeId tube, int end, std::size_t k) {
        return ring_v_[(2 * std::size_t{tube.index()} + static_cast<std::size_t>(end)) * sides_ + k % sides_];
    }
    void set_sides(NodeId tube);
    void set_forks(NodeId node);
    bool set_stem_face(std::uint32_t cage_quad, NodeId node);
    void find_collar(std::uint32_t cage_quad, NodeId node, std::vector<Collar>& collars) const;
    void set_collar(const Collar& collar, float length);
    void begin_zone(NodeId tube, std::uint32_t wraps_before);
    void set_rim(NodeId node, NodeId lateral, std::span<const Collar> collars);
    std::vector<TexturePoint> find_rim(NodeId node, NodeId lateral, std::span<const Collar> collars) const;
    std::uint32_t find_base(NodeId lateral, std::uint32_t side, std::span<const Collar> collars) const;
    std::optional<Side> find_side_of_stem(NodeId node, std::uint32_t from, std::uint32_t to) const;
    TexturePoint point_on_side(const Side& side, std::uint32_t step) const;
    void set_rectangle(std::uint32_t cage_quad, NodeId tube, int end, std::array<float, 2> columns,
                       const std::array<float, 4>& v);
    float column_length(std::uint32_t cage_quad) const;
    float row_length(std::uint32_t cage_quad) const;

    const QuadBuild& build_;
    TextureOptions options_;
    SlotOptions slots_;
    std::optional<RadiiBeyond> beyond_;  // if twigs have another tile
    TubeRows tube_rows_;
    std::vector<TubeFaces> faces_;  // per tube
    CageView cage_;
    std::uint32_t size_, sides_;
    std::uint32_t axis_count_ = 0;
    std::vector<Tube> tube_;
    std::vector<TexturePatch> patch_;  // per cage quad
    Buffer<float> rows_;  // shares of the length at size_ + 1 rows per tube, then those at equal distances
    std::vector<float> ring_v_;  // v at the rings of each tube, first at its beginning
    std::vector<BlendZone> zones_;
};

}  // namespace coppice::pipeline_internal
