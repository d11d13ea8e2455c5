#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/skeleton/raw.h"
#include "coppice/sketch/trace/mask.h"
#include "coppice/sketch/view.h"

namespace coppice::sketch_internal {

inline constexpr std::uint32_t kNoCell = 0xffffffff;  ///< stands for none, of cells and of pieces

/// How far places of a picture lie within its silhouette.
class SilhouetteField {
  public:
    /// Throws InvalidInput when nothing is inside. O(pixels).
    explicit SilhouetteField(const Mask& mask);

    /// [pixels] to the silhouette's edge: above 0 within it, below 0 off it, where it may be farther than
    /// that; none beyond the picture, which says nothing of what lies there.
    std::optional<double> inside_by(PicturePoint p) const;
    /// The corners of least and greatest coordinates of the box about the silhouette.
    std::array<PicturePoint, 2> box() const;

  private:
    int width_, height_;                               ///< of the picture
    int left_ = 0, top_ = 0, columns_ = 0, rows_ = 0;  ///< of the part that is kept
    std::vector<float> inside_by_;                     ///< of its pixels
};

/// A cell of a hull: its numbers along x, y and z.
using Cell = std::array<std::int32_t, 3>;

/// What silhouettes leave of space: the cells that no picture shows outside [Laurentini1994].
struct Hull {
    Vec3d corner;                   ///< [m] of cell (0, 0, 0), where its coordinates are least
    double size = 0;                ///< [m] of a cell
    std::vector<Cell> cells;        ///< in order of z, y, x
    std::vector<double> clearance;  ///< [m] of every cell: radius of the largest ball about it that is within

    Vec3d center(std::uint32_t i) const {  ///< [m]
        const Cell& c = cells[i];
        return corner + Vec3d{c[0] + 0.5, c[1] + 0.5, c[2] + 0.5} * size;
    }
    double thickness(std::uint32_t i) const {  ///< [m] > 0: the clearance, of what is thinner half a cell
        return (clearance[i] > 0 ? clearance[i] : 0) + 0.5 * size;
    }
};

/// Carved by an octree, to cells of about a pixel, a million at most. Where less than half of the views look
/// there is nothing. O(cells * views). Throws InvalidInput when all views look the same way; Cancelled.
Hull hull_of(std::span<const SketchView> views, std::span<const SilhouetteField> fields, const Context& ctx);

/// A way through a hull between two forks, or from a fork to an end.
struct HullPiece {
    std::vector<std::uint32_t> cells;  ///< from the fork, or foot, to the next fork or its end
    std::uint32_t before = kNoCell;    ///< the piece that it goes on from, which comes before it
    bool is_tip = false;               ///< it ends where no other one goes on
};

/// The tree of ways through the largest part of a hull from its foot to all that sticks out of it, along the
/// middle of what is widest [Sato2000]. O(cells log cells). Throws Cancelled.
std::vector<HullPiece> pieces_of(const Hull& hull, const Context& ctx);

/// Of these pieces those that show something of the silhouettes which others do not, and what they go on
/// from: a line that only lies behind or before others in all pictures is none. O(pixels of the pieces in all
/// views) for each end at worst, less as a rule. Throws Cancelled.
std::vector<HullPiece> explaining(const Hull& hull, std::span<const HullPiece> pieces,
                                  std::span<const SketchView> views, std::span<const SilhouetteField> fields,
                                  std::span<const Mask> silhouettes, const Context& ctx);

/// The axes of pieces, smooth, as wide as the hull; what leaves another piece has its own radius from its
/// start.
std::vector<RawNode> nodes_of(const Hull& hull, std::span<const HullPiece> pieces);

}  // namespace coppice::sketch_internal
