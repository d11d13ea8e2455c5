#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/implicit/solid/solid_field.h"

namespace coppice {

/// How finely a field is remembered, and how far from its surface.
struct CacheOptions {
    float cell = 0;  ///< [m] side of a cell; 0: 1/64 of the longest side of the box
    float band =
        0.1f;  ///< values nearer to the level than this are interpolated, others only on the right side
};

template <class Self, class Visitor>
requires SameOptions<Self, CacheOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"cell", "side of a cell of the cached field; 0 = 1/64 of the longest side", Unit::metre, 0,
                1e6},
          o.cell);
    visit(Field{"band", "values nearer to the level than this are kept", Unit::none, 0.001, 10}, o.band);
}

/// A field remembered on a grid around its surface: blocks of 8 x 8 x 8 cells where a value comes within
/// `band` of the level [Schmidt2005]. Between corners of cells, values are interpolated trilinearly, and
/// gradients are those of what is interpolated.
///
/// Where the field is twice differentiable, a value in the band is off by at most
/// cell^2 / 8 (|f_xx| + |f_yy| + |f_zz|), each the greatest in the cell: 2.25 (cell / R)^2 for one primitive
/// of influence R; at edges of unions and intersections by at most 0.87 cell |gradient|. `error` is measured.
///
/// Elsewhere a value is constant per block, with gradient 0, and on the right side of the band; 0 outside the
/// box. Satisfies FieldRef; the region is ignored. A look-up costs some 10 ns, whatever the field. Memory: 3
/// KiB a block. Copying copies the grid.
class CachedField {
  public:
    /// Blocks are found by the field's ranges: nothing is missed, however thin. InvalidInput for more than
    /// 2,000,000 blocks in all or 500,000 (1.5 GB) near the surface.
    explicit CachedField(const SolidField& field, const CacheOptions& options = {}, const Context& ctx = {});
    /// Any field, within a box: every cell is sampled; what is smaller than a cell may be missed. What the
    /// field says of a point must not depend on the other points of a call.
    CachedField(FieldRef field, const Box3& box, const CacheOptions& options = {}, const Context& ctx = {});

    float level() const { return level_; }                   ///< that of the field
    float cell() const { return cell_; }                     ///< [m] side of a cell
    std::span<const Box3> blocks() const { return boxes_; }  ///< those near the surface
    /// The lowest corners of the cells, all of side `cell`, in which some interpolated value lies in [low,
    /// high]: who draws points with such values need not look elsewhere. In a fixed order.
    std::vector<Vec3> cells_between(float low, float high, const Context& ctx = {}) const;
    /// The greatest difference found, at the centres of 64 cells of every block near the surface.
    float error() const { return error_; }

    /// Value and gradient at each point. Thread safe.
    void sample(std::uint32_t region, std::span<const Vec3> points, std::span<FieldSample> out) const;
    void values(std::span<const Vec3> points, std::span<float> out) const;  ///< The values alone.

  private:
    struct Builder;
    struct Place;
    bool locate(Vec3 p, Place& place) const;

    float level_ = 0, cell_ = 1, error_ = 0;
    Vec3d origin_;
    double per_cell_ = 1;
    std::uint32_t blocks_x_ = 0, blocks_y_ = 0, blocks_z_ = 0;
    std::vector<std::uint32_t> stored_;  ///< per block: which of boxes_, or kConstant
    std::vector<float> constant_;        ///< per block
    std::vector<Box3> boxes_;
    std::vector<float> values_;  ///< 729 a stored block
};

}  // namespace coppice
