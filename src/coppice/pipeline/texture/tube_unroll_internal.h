#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/mesh/texture.h"
#include "coppice/pipeline/texture/atlas_faces_internal.h"

namespace coppice::pipeline_internal {

/// Charts of a connected piece of bark coordinates.
struct UnrolledTube {
    std::vector<Chart> charts;  ///< from its beginning to its end
    Chart left;                 ///< faces that would be turned over or stretched
};

/// Unrolls connected pieces of bark coordinates into the plane: the width of a row, in metres, follows the
/// surface, and rows are as far apart as they are high. Points with different coordinates stay apart.
class TubeUnroll {
  public:
    /// The arguments must outlive this object. `welded`: per corner, the one with its coordinates.
    /// `max_length`: [m] of a chart.
    TubeUnroll(const AtlasFaces& faces, std::span<const TexturePoint> bark,
               std::span<const std::uint32_t> welded, float max_length)
        : faces_(faces), bark_(bark), welded_(welded), max_length_(max_length) {}

    /// Sets the points of the corners of some faces, and divides the faces into charts. O(n log n).
    UnrolledTube run(const Chart& piece, std::span<PlanePoint> points) const;

  private:
    // A place along a tube.
    struct Place {
        double v = 0;
        double width = 0;   // [m] of one tile
        double length = 0;  // [m] from the first place
    };
    // Sums over the faces near a place.
    struct Sums {
        double v = 0, area = 0, texture_area = 0;
    };

    TexturePoint bark(std::size_t corner) const { return bark_[welded_[corner]]; }
    double mean_v(std::uint32_t face) const;
    Sums sums(std::uint32_t face) const;
    std::vector<Place> find_places(const Chart& piece) const;
    std::vector<double> find_cuts(const std::vector<Place>& places, double range) const;
    bool is_good(std::uint32_t face, std::span<const PlanePoint> points) const;

    const AtlasFaces& faces_;
    std::span<const TexturePoint> bark_;
    std::span<const std::uint32_t> welded_;
    float max_length_;
};

}  // namespace coppice::pipeline_internal
