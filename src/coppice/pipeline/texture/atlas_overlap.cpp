#include "coppice/pipeline/texture/atlas_overlap_internal.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "coppice/base/id.h"

namespace coppice::pipeline_internal {
namespace {

// Maximum number of charts into which one is divided; other faces are rejected.
constexpr int kMaxParts = 8;

// Returns twice the area of a triangle, positive if it is counter-clockwise.
std::int64_t doubled_area(LatticePoint a, LatticePoint b, LatticePoint c) {
    return (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) -
           (std::int64_t{c.x} - a.x) * (std::int64_t{b.y} - a.y);
}

// Returns whether a line along an edge of `a` separates two convex polygons.
bool is_separated_by_edge(std::span<const LatticePoint> a, std::span<const LatticePoint> b) {
    for (std::size_t k = 0; k < a.size(); ++k) {
        const LatticePoint from = a[k], to = a[k + 1 < a.size() ? k + 1 : 0];
        if (std::ranges::all_of(b, [&](LatticePoint p) { return doubled_area(from, to, p) <= 0; }))
            return true;
    }
    return false;
}

struct LatticeBox {
    LatticePoint min{std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::max()};
    LatticePoint max{std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::min()};

    void extend(LatticePoint p) {
        min = {std::min(min.x, p.x), std::min(min.y, p.y)};
        max = {std::max(max.x, p.x), std::max(max.y, p.y)};
    }
    bool overlaps(const LatticeBox& o) const {
        return min.x < o.max.x && o.min.x < max.x && min.y < o.max.y && o.min.y < max.y;
    }
};

LatticeBox find_box(std::span<const LatticePoint> points) {
    LatticeBox out;
    for (const LatticePoint p : points) out.extend(p);
    return out;
}

// A grid of faces that do not overlap each other.
class FaceGrid {
  public:
    FaceGrid(const AtlasFaces& faces, const Chart& chart, std::span<const LatticePoint> points)
        : faces_(faces), points_(points) {
        for (const std::uint32_t f : chart) {
            const LatticeBox own = find_box(faces_.values(points_, f));
            box_.extend(own.min);
            box_.extend(own.max);
        }
        const double width = static_cast<double>(std::int64_t{box_.max.x} - box_.min.x),
                     height = static_cast<double>(std::int64_t{box_.max.y} - box_.min.y);
        cell_ = std::max(std::sqrt(width * height / static_cast<double>(chart.size())), 1.0);
        columns_ = static_cast<std::uint32_t>(width / cell_) + 1;
        const std::uint32_t rows = static_cast<std::uint32_t>(height / cell_) + 1;
        last_.assign(std::size_t{columns_} * rows, kNoIndex);
    }

    // Adds a face unless it overlaps another one. Returns whether it was added.
    bool add(std::uint32_t face) {
        const auto points = faces_.values(points_, face);
        const LatticeBox box = find_box(points);
        const Cells cells = cells_of_box(box);
        if (overlaps_any(points, box, cells)) return false;
        for_each(cells, [&](std::uint32_t& last) {
            entries_.push_back({face, last});
            last = static_cast<std::uint32_t>(entries_.size() - 1);
            return true;
        });
        return true;
    }

  private:
    struct Cells {
        std::uint32_t left, bottom, right, top;
    };
    struct Entry {
        std::uint32_t face, before;  // in the same cell
    };

    Cells cells_of_box(const LatticeBox& b) const {
        const auto index = [&](std::int32_t x, std::int32_t origin) {
            return static_cast<std::uint32_t>(static_cast<double>(std::int64_t{x} - origin) / cell_);
        };
        return {index(b.min.x, box_.min.x), index(b.min.y, box_.min.y), index(b.max.x, box_.min.x),
                index(b.max.y, box_.min.y)};
    }

    // Calls visit(last entry) for the cells until it returns false. Returns whether it always returned true.
    template <class Visit>
    bool for_each(const Cells& cells, const Visit& visit) {
        for (std::uint32_t row = cells.bottom; row <= cells.top; ++row) {
            for (std::uint32_t column = cells.left; column <= cells.right; ++column) {
                if (!visit(last_[std::size_t{row} * columns_ + column])) return false;
            }
        }
        return true;
    }

    bool overlaps_any(std::span<const LatticePoint> points, const LatticeBox& box, const Cells& cells) {
        return !for_each(cells, [&](std::uint32_t last) {
            for (std::uint32_t e = last; e != kNoIndex; e = entries_[e].before) {
                const auto other = faces_.values(points_, entries_[e].face);
                if (box.overlaps(find_box(other)) && do_overlap(points, other)) return false;
            }
            return true;
        });
    }

    const AtlasFaces& faces_;
    std::span<const LatticePoint> points_;
    LatticeBox box_;
    double cell_ = 1;
    std::uint32_t columns_ = 1;
    std::vector<std::uint32_t> last_;  // entry of each cell
    std::vector<Entry> entries_;
};

}  // namespace

bool is_convex(std::span<const LatticePoint> polygon) {
    const std::size_t n = polygon.size();
    for (std::size_t k = 0; k < n; ++k) {
        if (doubled_area(polygon[k], polygon[(k + 1) % n], polygon[(k + 2) % n]) <= 0) return false;
        // All triangles at the first corner are positive only if the polygon surrounds its inside once.
        if (k > 0 && k + 1 < n && doubled_area(polygon[0], polygon[k], polygon[k + 1]) <= 0) return false;
    }
    return true;
}

bool do_overlap(std::span<const LatticePoint> a, std::span<const LatticePoint> b) {
    return !is_separated_by_edge(a, b) && !is_separated_by_edge(b, a);
}

SplitChart split_chart(const AtlasFaces& faces, const Chart& chart, std::span<const LatticePoint> points) {
    SplitChart out;
    Chart open;
    for (const std::uint32_t f : chart) {
        Chart& list = is_convex(faces.values(points, f)) ? open : out.rejected;
        list.push_back(f);
    }
    for (int part = 0; part < kMaxParts && !open.empty(); ++part) {
        FaceGrid grid(faces, open, points);
        Chart added, rest;
        for (const std::uint32_t f : open) {
            Chart& list = grid.add(f) ? added : rest;
            list.push_back(f);
        }
        open = std::move(rest);
        if (added.size() == chart.size()) return {{std::move(added)}, {}};
        std::ranges::move(find_connected_parts(faces, added, points), std::back_inserter(out.charts));
    }
    out.rejected.insert(out.rejected.end(), open.begin(), open.end());
    return out;
}

}  // namespace coppice::pipeline_internal
