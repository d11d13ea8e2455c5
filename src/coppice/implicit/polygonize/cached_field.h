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

/// Options of CachedField.
struct CacheOptions {
    float cell = 0;     ///< [m] side of a cell; 0: 1/64 of the longest side of the box
    float band = 0.1f;  ///< maximum difference from the iso value of interpolated values; other values are
                        ///< only on the correct side
};

/// Lists the members for front ends.
void list_fields(CacheOptions& o, FieldList& list);

/// A field cached on a grid around its surface: blocks of 8 x 8 x 8 cells that contain a value within `band`
/// of the iso value [Schmidt2005]. Between corners of cells, values are interpolated trilinearly; gradients
/// are those of the interpolation.
///
/// Where the field is twice differentiable, the error of a value in the band is at most cell^2 / 8 (|f_xx| +
/// |f_yy| + |f_zz|), with the maximum of each in the cell: 2.25 (cell / R)^2 for one primitive of influence
/// R; at edges of unions and intersections at most 0.87 cell |gradient|. `error` is measured.
///
/// Elsewhere a value is constant per block, with gradient 0, and on the correct side of the band; 0 outside
/// the box. Satisfies FieldRef; the region is ignored. A look-up takes about 10 ns for any field. Memory: 3
/// KiB a block. Copying copies the grid.
class CachedField {
  public:
    /// Finds blocks by the field's ranges, so that thin features are not missed. Throws InvalidInput for more
    /// than 2,000,000 blocks in total or 500,000 (1.5 GB) near the surface.
    explicit CachedField(const SolidField& field, const CacheOptions& options = {}, const Context& ctx = {});
    /// Caches any field within a box: every cell is sampled; features smaller than a cell may be missed. The
    /// value at a point must not depend on the other points of a call.
    CachedField(FieldRef field, const Box3& box, const CacheOptions& options = {}, const Context& ctx = {});

    float level() const { return level_; }                   ///< iso value of the field
    float cell() const { return cell_; }                     ///< [m] side of a cell
    std::span<const Box3> blocks() const { return boxes_; }  ///< blocks near the surface
    /// Returns the lowest corners of the cells of side `cell` that contain an interpolated value in [low,
    /// high], so that points with such values are only in these cells. In a fixed order.
    std::vector<Vec3> cells_between(float low, float high, const Context& ctx = {}) const;
    /// Returns the maximum measured error, at the centres of 64 cells of every block near the surface.
    float error() const { return error_; }

    /// Evaluates value and gradient at each point. Thread safe.
    void sample(std::uint32_t region, std::span<const Vec3> points, std::span<FieldSample> out) const;
    void values(std::span<const Vec3> points, std::span<float> out) const;  ///< Evaluates only the values.

  private:
    struct Builder;
    struct Place;
    bool locate(Vec3 p, Place& place) const;

    float level_ = 0, cell_ = 1, error_ = 0;
    Vec3d origin_;
    double per_cell_ = 1;
    std::uint32_t blocks_x_ = 0, blocks_y_ = 0, blocks_z_ = 0;
    std::vector<std::uint32_t> stored_;  ///< per block: index of boxes_, or kConstant
    std::vector<float> constant_;        ///< per block
    std::vector<Box3> boxes_;
    std::vector<float> values_;  ///< 729 per stored block
};

}  // namespace coppice
