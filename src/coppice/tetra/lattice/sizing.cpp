#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/tetra/lattice/sizing_internal.h"

namespace coppice {
namespace {

constexpr std::uint32_t kMaxNodes = 1u << 24;
/// maximum number of intersections of segments with cells of one level
constexpr std::size_t kMaxOpen = std::size_t{1} << 24;
constexpr double kHalfDiagonal = 0.8660254037844387;  ///< of a cube of side 1

/// A bounding box in double precision.
struct Range {
    Vec3d low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

    void extend(Vec3 center, double radius) {
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], center[axis] - radius);
            high[axis] = std::max(high[axis], center[axis] + radius);
        }
    }
};

Range compute_range(std::span<const Segment> segments, double reach) {
    Range out;
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const Segment& s = segments[i];
        const auto positive = [](float r) { return r > 0 && std::isfinite(r); };
        if (!is_finite(s.a) || !is_finite(s.b) || !positive(s.radius_a) || !positive(s.radius_b)) {
            throw InvalidInput(
                fmt::format("lattice: segment {} must have finite ends and radii above 0; repair it", i));
        }
        out.extend(s.a, reach * s.radius_a);
        out.extend(s.b, reach * s.radius_b);
    }
    return out;
}

/// Sides of cells are the side of the cube over powers of two, so the cells of a segment are between half as
/// wide as it allows and as wide. Returns the number of eighths, 8 to 15, with which most segments have cells
/// half as wide as they allow: where a thick branch carries a thin one, its cells must not be wider than
/// those of the thin one, so cells are most uniform. (With cells as wide as allowed, the spread of edge
/// lengths over the local radius is larger by half.)
int even_eighths(std::span<const Segment> segments, double cell) {
    std::array<double, 8> cells{};
    for (const Segment& s : segments) {
        const double r = std::min(s.radius_a, s.radius_b), along = distance(Vec3d(s.a), Vec3d(s.b)) / r;
        int exponent = 0;
        const double most = 2 * std::frexp(cell * r, &exponent);  // in [1, 2)
        for (int i = 0; i < 8; ++i) {
            const double unit = (8 + i) / 8.0;
            const double side = cell * (unit <= most ? unit : unit / 2) / most;
            cells[static_cast<std::size_t>(i)] +=
                (2 + side) * (2 + side) * (along + 2 + side) / (side * side * side);
        }
    }
    return 8 + static_cast<int>(std::ranges::max_element(cells) - cells.begin());
}

/// Moves the cube, in steps of an eighth of its side, to the position that covers most; returns whether it
/// covers all.
bool place_cube(LatticeCube& cube, const Range& range) {
    const double step = cube.side / 8;
    bool covers = true;
    for (int axis = 0; axis < 3; ++axis) {
        cube.low[axis] = std::floor(range.low[axis] / step) * step;
        covers &= cube.low[axis] + cube.side >= range.high[axis];
    }
    return covers;
}

[[noreturn]] void throw_too_many() {
    throw InvalidInput(
        "lattice: the segments are too thin for their length, or too many are at one place: more than 16 "
        "million cells are required; choose a larger cell, thicker segments or a part of the skeleton");
}

enum class Fate : std::uint8_t { leaf, split, too_small };

class Sizing {
  public:
    Sizing(std::span<const RoundCone> cones, const LatticeCube& cube, const LatticeOptions& options,
           const Context& ctx)
        : cones_(cones), cube_(cube), options_(options), ctx_(ctx) {}

    LatticeSizing run() {
        start();
        for (unsigned level = 1; !out_.split.back().empty(); ++level) descend(level);
        out_.split.pop_back();
        return std::move(out_);
    }

  private:
    using Place = std::array<std::uint32_t, 3>;  ///< [sides of a cell]

    /// Returns the position of child number i of the cells to split.
    Place child_place(std::size_t i) const {
        const Place& p = open_place_[i / 8];
        const auto up = [&](unsigned axis) { return static_cast<std::uint32_t>(i >> axis & 1); };
        return {2 * p[0] + up(0), 2 * p[1] + up(1), 2 * p[2] + up(2)};
    }

    /// Results of one range of children.
    struct Found {
        std::vector<std::uint32_t> kept, open;  ///< segments of leaves, of cells to split
        std::uint32_t too_thin = kNoIndex;
    };

    void start() {
        open_.resize(cones_.size());
        for (std::uint32_t i = 0; i < open_.size(); ++i) open_[i] = i;
        open_first_.assign({0, open_.size()});
        open_place_.assign(1, {0, 0, 0});
        out_.split.assign(1, Buffer<std::uint64_t>{0});
        out_.split_number.assign(1, 0);
        out_.first.assign(1, 0);
        out_.count.assign(1, 0);
    }

    void descend(unsigned level) {
        const Buffer<std::uint64_t>& parents = out_.split.back();
        const std::size_t children = 8 * parents.size(), node = out_.count.size();
        if (node + children > kMaxNodes || open_.size() > kMaxOpen) throw_too_many();
        for (auto* column : {&out_.split_number, &out_.count}) column->resize(node + children);
        out_.first.resize(node + children);
        const std::size_t grain = std::clamp<std::size_t>(children / 256, 1, 256);
        std::vector<Found> found((children + grain - 1) / grain);
        parallel_for_ranges(ctx_, children, grain, [&](IndexRange range) {
            Found& f = found[range.begin / grain];
            for (std::size_t i = range.begin; i < range.end; ++i) judge(level, i, node + i, f);
        });
        gather(found, node, grain);
        number(parents, node, children);
    }

    void judge(unsigned level, std::size_t i, std::size_t node, Found& f) {
        const double side = std::ldexp(cube_.side, -static_cast<int>(level));
        const Place place = child_place(i);
        const Vec3d center{(place[0] + 0.5) * side, (place[1] + 0.5) * side, (place[2] + 0.5) * side};
        const std::size_t begin = f.open.size();
        const std::uint32_t thin = meet(i / 8, center, side, f.open);
        out_.count[node] = static_cast<std::uint32_t>(f.open.size() - begin);
        out_.split_number[node] = thin == kNoIndex ? kNoIndex : 0;
        if (thin == kNoIndex) {
            out_.first[node] = f.kept.size();
            f.kept.insert(f.kept.end(), f.open.begin() + static_cast<std::ptrdiff_t>(begin), f.open.end());
            f.open.resize(begin);
        } else if (level >= cube_.levels) {
            f.too_thin = std::min(f.too_thin, thin);
        }
    }

    /// Appends the segments of the parent that intersect a cell; if one contains the cell, appends it and
    /// those with axes in the cell instead. Returns the first that is too thin for the cell.
    std::uint32_t meet(std::size_t parent, Vec3d center, double side, std::vector<std::uint32_t>& out) const {
        const std::size_t begin = out.size();
        const double reach = kHalfDiagonal * side, min_radius = side / options_.cell;
        const auto lowest = [&](Vec3d n, double) {
            return dot(n, center) - 0.5 * side * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
        };
        std::uint32_t thin = kNoIndex;
        for (std::size_t k = open_first_[parent]; k < open_first_[parent + 1]; ++k) {
            const RoundCone& cone = cones_[open_[k]];
            const auto radius = thinnest_ball_meeting(cone, options_.outside, center, reach);
            if (!radius || separated(cone, options_.outside, center, lowest)) continue;
            if (holds_ball(cone, options_.inside, center, reach)) {
                out.resize(begin);
                name_axes(parent, open_[k], center, lowest, out);
                return kNoIndex;
            }
            out.push_back(open_[k]);
            if (thin == kNoIndex && *radius < min_radius) thin = open_[k];
        }
        return thin;
    }

    /// Appends the segment that contains a cell, and those with axes that pass through it.
    template <class Lowest>
    void name_axes(std::size_t parent, std::uint32_t holder, Vec3d center, const Lowest& lowest,
                   std::vector<std::uint32_t>& out) const {
        out.push_back(holder);
        for (std::size_t k = open_first_[parent]; k < open_first_[parent + 1]; ++k) {
            if (open_[k] != holder && !separated(cones_[open_[k]], 0, center, lowest))
                out.push_back(open_[k]);
        }
    }

    void gather(std::vector<Found>& found, std::size_t node, std::size_t grain) {
        std::vector<std::size_t> kept, open;
        std::uint32_t thin = kNoIndex;
        for (const Found& f : found) {
            kept.push_back(f.kept.size());
            open.push_back(f.open.size());
            thin = std::min(thin, f.too_thin);
        }
        if (thin != kNoIndex) {
            throw InvalidInput(
                fmt::format("lattice: segment {} has a radius of {:.3g} m, too thin for coordinates of "
                            "{:.3g} m; make it thicker",
                            thin, cones_[thin].radius_a, cube_.side));
        }
        const std::size_t before = out_.segments.size();
        out_.segments.resize(before + exclusive_scan<std::size_t>(kept));
        open_.resize(exclusive_scan<std::size_t>(open));
        parallel_for(ctx_, found.size(), 1, [&](std::size_t i) {
            std::ranges::copy(found[i].kept,
                              out_.segments.begin() + static_cast<std::ptrdiff_t>(before + kept[i]));
            std::ranges::copy(found[i].open, open_.begin() + static_cast<std::ptrdiff_t>(open[i]));
            const std::size_t end = std::min(out_.count.size(), node + (i + 1) * grain);
            for (std::size_t n = node + i * grain; n < end; ++n) {
                if (out_.split_number[n] == kNoIndex) out_.first[n] += before + kept[i];
            }
        });
    }

    /// Numbers the cells to split and lists them by key.
    void number(const Buffer<std::uint64_t>& parents, std::size_t node, std::size_t children) {
        Buffer<std::uint64_t> split;
        Buffer<Place> place;
        open_first_.assign(1, 0);
        for (std::size_t i = 0; i < children; ++i) {
            if (out_.split_number[node + i] == kNoIndex) continue;
            out_.split_number[node + i] = ++numbered_;
            split.push_back(parents[i / 8] << 3 | (i & 7));
            place.push_back(child_place(i));
            open_first_.push_back(open_first_.back() + out_.count[node + i]);
            out_.first[node + i] = 0;
            out_.count[node + i] = 0;
        }
        out_.split.push_back(std::move(split));
        open_place_ = std::move(place);
    }

    std::span<const RoundCone> cones_;
    const LatticeCube& cube_;
    const LatticeOptions& options_;
    const Context& ctx_;
    LatticeSizing out_;
    Buffer<std::uint32_t> open_;  ///< segments of the cells of the last level to split, concatenated
    std::vector<std::size_t> open_first_;
    Buffer<Place> open_place_;
    std::uint32_t numbered_ = 0;  ///< the last split cell; number 0 is the cube
};

}  // namespace

LatticeCube lattice_cube(std::span<const Segment> segments, const LatticeOptions& options) {
    if (segments.empty())
        throw InvalidInput("lattice: there are no segments; use a skeleton with at least one segment");
    const Range range = compute_range(segments, 1.01 * (options.outside + options.cell));
    const Vec3d size = range.high - range.low;
    LatticeCube cube;
    cube.side = even_eighths(segments, options.cell) / 8.0 *
                std::exp2(std::floor(std::log2(std::max({size.x, size.y, size.z}))));
    while (!place_cube(cube, range)) cube.side *= 2;
    double farthest = 0;
    for (int axis = 0; axis < 3; ++axis)
        farthest = std::max({farthest, -cube.low[axis], cube.low[axis] + cube.side});
    // Floats below 2^e are multiples of 2^(e - 24), and of 2^-149. Centers are at half cells, in units of an
    // eighth of the side.
    const int finest = std::max(static_cast<int>(std::ceil(std::log2(farthest))) - 24, -149);
    const int levels = std::ilogb(cube.side) - 4 - finest;
    if (levels < 2 || farthest > std::numeric_limits<float>::max()) {
        throw InvalidInput(
            "lattice: the segments are too thin for their distance from the origin; move them to the origin");
    }
    cube.levels = std::min(static_cast<unsigned>(levels), Octree::kMaxLevels);
    return cube;
}

LatticeSizing size_cells(std::span<const RoundCone> cones, const LatticeCube& cube,
                         const LatticeOptions& options, const Context& ctx) {
    return Sizing(cones, cube, options, ctx).run();
}

}  // namespace coppice
