#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/sketch/trace/hull_internal.h"
#include "coppice/sketch/trace/silhouette_internal.h"

namespace coppice::sketch_internal {
namespace {

constexpr int kMargin = 2;                    // [pixels] around a silhouette
constexpr double kWide = 1.3;                 // [size of the silhouettes] edge length of the bounding cube
constexpr std::size_t kMaxCells = 1'000'000;  // limits memory: 26 neighbours of each cell are stored
constexpr double kFinest = 1.5;               // [pixels] minimum size of cells that are subdivided
constexpr double kLarge = 0.1;  // [half of the cube] larger cells may be partially visible in further views

/// Returns the point closest to the lines of sight through the centres of the silhouettes.
Vec3d compute_middle(std::span<const SketchView> views, std::span<const SilhouetteField> fields) {
    // Solves sum (I - d d^T) (x - o) = 0 by Cramer's rule.
    std::array<Vec3d, 3> m{};
    Vec3d right{};
    for (std::size_t v = 0; v < views.size(); ++v) {
        const auto [low, high] = fields[v].box();
        const ViewRay r = ray(views[v], (low + high) * 0.5);
        const Vec3d d = r.direction;
        const std::array<Vec3d, 3> rows{Vec3d{1, 0, 0} - d * d.x, Vec3d{0, 1, 0} - d * d.y,
                                        Vec3d{0, 0, 1} - d * d.z};
        for (std::size_t i = 0; i < 3; ++i) m[i] += rows[i];
        right += {dot(rows[0], r.origin), dot(rows[1], r.origin), dot(rows[2], r.origin)};
    }
    const double whole = dot(m[0], cross(m[1], m[2]));
    if (!(std::abs(whole) > 1e-12))
        throw InvalidInput(
            "trace: all views look the same way, so that the depth of the tree is unknown; add a view from "
            "another side");
    // The matrix is symmetric, so its rows are its columns.
    return Vec3d{dot(right, cross(m[1], m[2])), dot(m[0], cross(right, m[2])),
                 dot(m[0], cross(m[1], right))} /
           whole;
}

class Carver {
  public:
    Carver(std::span<const SketchView> views, std::span<const SilhouetteField> fields)
        : views_(views), fields_(fields) {
        middle_ = compute_middle(views, fields);
        for (std::size_t v = 0; v < views.size(); ++v) {
            const auto [low, high] = fields[v].box();
            const double scale = pixels_per_metre(views[v], middle_);
            half_ = std::max(half_, kWide * 0.5 * length(high - low) / scale);
            pixel_ = std::min(pixel_, 1 / scale);
        }
    }

    Hull run(const Context& ctx) {
        Hull hull;
        std::vector<Cell> cells{{0, 0, 0}};
        double size = 2 * half_;
        while (size > kFinest * pixel_) {
            std::vector<Cell> finer = halves(cells, 0.5 * size, ctx);
            if (finer.size() > kMaxCells) break;
            cells = std::move(finer);
            size *= 0.5;
        }
        hull.corner = corner();
        hull.size = size;
        std::ranges::sort(cells, [](const Cell& a, const Cell& b) {
            return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]);
        });
        hull.cells = std::move(cells);
        hull.clearance.resize(hull.cells.size());
        parallel_for(ctx, hull.cells.size(), 4096,
                     [&](std::size_t i) { hull.clearance[i] = clearance(hull.center(i)); });
        return hull;
    }

  private:
    Vec3d corner() const { return middle_ - Vec3d{half_, half_, half_}; }

    std::vector<Cell> halves(const std::vector<Cell>& cells, double size, const Context& ctx) const {
        std::vector<std::uint8_t> kept(cells.size(), 0);
        const auto part = [](const Cell& c, int k) {
            return Cell{2 * c[0] + (k & 1), 2 * c[1] + (k >> 1 & 1), 2 * c[2] + (k >> 2 & 1)};
        };
        parallel_for(ctx, cells.size(), 1024, [&](std::size_t i) {
            for (int k = 0; k < 8; ++k)
                if (may_hold(part(cells[i], k), size)) kept[i] |= static_cast<std::uint8_t>(1 << k);
        });
        std::vector<Cell> out;
        for (std::size_t i = 0; i < cells.size(); ++i)
            for (int k = 0; k < 8; ++k)
                if ((kept[i] >> k & 1) != 0) out.push_back(part(cells[i], k));
        return out;
    }

    /// Returns whether no view that contains a cell shows it outside the silhouette.
    bool may_hold(const Cell& c, double size) const {
        const Vec3d p = corner() + Vec3d{c[0] + 0.5, c[1] + 0.5, c[2] + 0.5} * size;
        const double reach = 0.5 * std::sqrt(3.0) * size;
        std::size_t deciding = 0;
        bool near = false;
        for (std::size_t v = 0; v < views_.size(); ++v) {
            const bool perspective = views_[v].projection == Projection::perspective;
            const double away = perspective ? depth(views_[v], p) - reach : 1;
            if (away <= 0) {
                near = true;
                continue;
            }
            const auto by = fields_[v].inside_by(project(views_[v], p));
            if (!by) continue;
            ++deciding;
            const double scale = pixels_per_metre(views_[v], p) * (perspective ? (away + reach) / away : 1);
            if (*by < -reach * scale - 0.5) return false;
        }
        // Space that fewer than half of the images show is removed, except large cells, which may be
        // partially visible in others.
        return near || 2 * deciding >= views_.size() || reach > kLarge * half_;
    }

    /// Returns the radius of the largest ball around p inside the hull: a ball is inside if its image is
    /// inside every silhouette.
    double clearance(Vec3d p) const {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t v = 0; v < views_.size(); ++v)
            if (const auto by = fields_[v].inside_by(project(views_[v], p)))
                least = std::min(least, *by / pixels_per_metre(views_[v], p));
        return least;
    }

    std::span<const SketchView> views_;
    std::span<const SilhouetteField> fields_;
    Vec3d middle_;
    double half_ = 0;  ///< [m] half the edge length of the bounding cube
    /// [m] pixel size of the image with the highest resolution
    double pixel_ = std::numeric_limits<double>::infinity();
};

}  // namespace

SilhouetteField::SilhouetteField(const Mask& mask) : width_(mask.width), height_(mask.height) {
    int right = -1, bottom = -1;
    left_ = mask.width;
    top_ = mask.height;
    for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
            if (!mask.at(x, y)) continue;
            left_ = std::min(left_, x), right = std::max(right, x);
            top_ = std::min(top_, y), bottom = std::max(bottom, y);
        }
    }
    if (right < 0) throw InvalidInput("trace: a silhouette is empty");
    left_ = std::max(left_ - kMargin, 0), right = std::min(right + kMargin, mask.width - 1);
    top_ = std::max(top_ - kMargin, 0), bottom = std::min(bottom + kMargin, mask.height - 1);
    columns_ = right - left_ + 1;
    rows_ = bottom - top_ + 1;
    Mask part(columns_, rows_);
    for (int y = 0; y < rows_; ++y)
        for (int x = 0; x < columns_; ++x)
            part.inside[part.index(x, y)] = mask.at(left_ + x, top_ + y) ? 1 : 0;
    inside_by_ = distance_to_outside(part);
    const std::vector<float> off = distance_to_inside(part);
    for (std::size_t i = 0; i < off.size(); ++i)
        inside_by_[i] = part.inside[i] != 0 ? inside_by_[i] - 0.5f : 0.5f - off[i];
}

std::optional<double> SilhouetteField::inside_by(PicturePoint p) const {
    if (!(p.x >= 0 && p.y >= 0 && p.x < width_ && p.y < height_)) return std::nullopt;
    const int x = static_cast<int>(p.x) - left_, y = static_cast<int>(p.y) - top_;
    const int near_x = std::clamp(x, 0, columns_ - 1), near_y = std::clamp(y, 0, rows_ - 1);
    if (near_x != x || near_y != y) return -std::hypot(near_x - x, near_y - y);
    return inside_by_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                      static_cast<std::size_t>(x)];
}

std::array<PicturePoint, 2> SilhouetteField::box() const {
    return {PicturePoint{double(left_), double(top_)},
            PicturePoint{double(left_ + columns_), double(top_ + rows_)}};
}

Hull compute_hull(std::span<const SketchView> views, std::span<const SilhouetteField> fields,
                  const Context& ctx) {
    return Carver(views, fields).run(ctx);
}

}  // namespace coppice::sketch_internal
