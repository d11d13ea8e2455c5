#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/id.h"
#include "coppice/skeleton/raw.h"
#include "coppice/sketch/trace/mask.h"
#include "coppice/sketch/view.h"

namespace coppice::sketch_internal {

/// Signed distance field of a silhouette.
class SilhouetteField {
  public:
    /// Throws InvalidInput if the silhouette is empty. O(pixels).
    explicit SilhouetteField(const Mask& mask);

    /// Returns the distance [pixels] to the edge of the silhouette: positive inside, negative outside, where
    /// it is an upper bound of the signed distance; none outside the image, which contains no information
    /// there.
    std::optional<double> inside_by(PicturePoint p) const;
    /// Returns the minimum and maximum corners of the bounding box of the silhouette.
    std::array<PicturePoint, 2> box() const;

  private:
    int width_, height_;                               ///< size of the image
    int left_ = 0, top_ = 0, columns_ = 0, rows_ = 0;  ///< stored section of the image
    std::vector<float> inside_by_;                     ///< by pixel of the stored section
};

/// A cell of a hull: its indices along x, y and z.
using Cell = std::array<std::int32_t, 3>;

/// Visual hull of silhouettes: the cells that no image shows outside [Laurentini1994].
struct Hull {
    Vec3d corner;                   ///< [m] minimum corner of cell (0, 0, 0)
    double size = 0;                ///< [m] edge length of a cell
    std::vector<Cell> cells;        ///< sorted by z, y, x
    std::vector<double> clearance;  ///< [m] by cell: radius of the largest ball around it inside the hull

    Vec3d center(std::uint32_t i) const {  ///< [m]
        const Cell& c = cells[i];
        return corner + Vec3d{c[0] + 0.5, c[1] + 0.5, c[2] + 0.5} * size;
    }
    double thickness(std::uint32_t i) const {  ///< [m] > 0: the clearance, at least half a cell
        return (clearance[i] > 0 ? clearance[i] : 0) + 0.5 * size;
    }
};

/// Computes the visual hull by an octree with cells of about a pixel, at most a million. Space that fewer
/// than half of the views show is empty. O(cells * views). Throws InvalidInput if all views look the same
/// way; Cancelled.
Hull compute_hull(std::span<const SketchView> views, std::span<const SilhouetteField> fields,
                  const Context& ctx);

/// A path through a hull between two forks, or from a fork to an end.
struct HullPath {
    std::vector<std::uint32_t> cells;  ///< from the fork or base to the next fork or the end
    std::uint32_t before = kNoIndex;   ///< the path that it continues, which has a smaller index
    bool is_tip = false;               ///< whether no other path continues it
};

/// Returns the tree of paths through the largest component of a hull from its base to all protruding ends,
/// along the centres of the widest sections [Sato2000]. O(cells log cells). Throws Cancelled.
std::vector<HullPath> find_paths(const Hull& hull, const Context& ctx);

/// Returns the paths that cover pixels of the silhouettes which other paths do not cover, with their
/// predecessors: a path that is behind or in front of others in all images is removed. At worst O(pixels of
/// the paths in all views) for each end, usually less. Throws Cancelled.
std::vector<HullPath> explaining(const Hull& hull, std::span<const HullPath> paths,
                                 std::span<const SketchView> views, std::span<const SilhouetteField> fields,
                                 std::span<const Mask> silhouettes, const Context& ctx);

/// Returns the smoothed axes of paths with the radii of the hull; a path that leaves another one has its
/// own radius from its start.
std::vector<RawNode> find_nodes(const Hull& hull, std::span<const HullPath> paths);

}  // namespace coppice::sketch_internal
