#include "coppice/tetra/march/held_internal.h"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/kernel/segment_distance.h"
#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"

namespace coppice::tetra_internal {
namespace {

using Local = TetraPattern::Local;
using Weights = std::array<double, 4>;  ///< barycentric coordinates

/// Weights this far below a bound count as at it: rounding finds a vertex too many, never one too few.
constexpr double kSlack = 1e-6;

/// The part of a line, from 0 to 1, in which linear functions are not negative.
struct Span {
    double from = 0, to = 1;

    void clip(double at_start, double at_end) {
        at_start += kSlack;
        at_end += kSlack;
        if (at_start < 0 && at_end < 0) {
            to = -1;
        } else if (at_start < 0) {
            from = std::max(from, at_start / (at_start - at_end));
        } else if (at_end < 0) {
            to = std::min(to, at_start / (at_start - at_end));
        }
    }
    bool empty() const { return from > to; }
};

/// The weights in a tetrahedron as linear functions of space.
class WeightFunctions {
  public:
    explicit WeightFunctions(const std::array<Vec3d, 4>& p) : origin_(p[0]) {
        const Vec3d x = p[1] - p[0], y = p[2] - p[0], z = p[3] - p[0];
        const double volume = dot(cross(x, y), z);
        slope_ = {cross(y, z) / volume, cross(z, x) / volume, cross(x, y) / volume};
    }

    Weights at(Vec3d p) const {
        const Vec3d w = p - origin_;
        const double x = dot(slope_[0], w), y = dot(slope_[1], w), z = dot(slope_[2], w);
        return {1 - x - y - z, x, y, z};
    }

  private:
    Vec3d origin_;
    std::array<Vec3d, 3> slope_;
};

/// The part of the line between two points in which all weights are those of a point inside.
Span within(const Weights& start, const Weights& end) {
    Span span;
    for (std::size_t i = 0; i < 4; ++i) {
        // Mostly it misses, which takes no division to see.
        if (start[i] < -kSlack && end[i] < -kSlack) return {1, 0};
    }
    for (std::size_t i = 0; i < 4; ++i) span.clip(start[i], end[i]);
    return span;
}

/// The fine tetrahedra that a line passes in one coarse tetrahedron, whose corners are a path of edges about
/// the diagonal: in coordinates along these edges, x >= y >= z from 0 to n, they are the pieces between the
/// planes on which a coordinate, or the difference of two, is whole [Freudenthal1942].
class FineLine {
  public:
    FineLine(const TetraPattern& pattern, std::uint32_t diagonal)
        : n_(1),
          path_{kTetraDiagonals[diagonal][0], kTetraDiagonals[diagonal][2], kTetraDiagonals[diagonal][1],
                kTetraDiagonals[diagonal][3]} {
        for (const std::uint8_t w : pattern.weights[0]) n_ = std::max(n_, int{w});
        const auto side = static_cast<std::size_t>(n_) + 1;
        local_.resize(side * side * side);
        for (std::size_t v = 0; v < pattern.weights.size(); ++v) {
            const auto& w = pattern.weights[v];
            const int z = w[path_[3]], y = z + w[path_[2]], x = y + w[path_[1]];
            local_[place({x, y, z})] = static_cast<Local>(v);
        }
    }

    /// Calls use(vertex) for those with the greatest weight somewhere between two points, which lie inside.
    template <class Use>
    void visit_greatest(const Weights& start, const Weights& end, const Use& use) {
        const Vec3d from = along_path(start), way = along_path(end) - from;
        find_stops(from, way);
        for (std::size_t i = 0; i + 1 < stops_.size(); ++i) {
            if (stops_[i + 1] > stops_[i] || stops_.size() == 2)
                visit_piece(from + way * stops_[i], from + way * stops_[i + 1], use);
        }
    }

  private:
    std::size_t place(const std::array<int, 3>& p) const {
        const auto side = static_cast<std::size_t>(n_) + 1;
        return (static_cast<std::size_t>(p[0]) * side + static_cast<std::size_t>(p[1])) * side +
               static_cast<std::size_t>(p[2]);
    }

    Vec3d along_path(const Weights& w) const {
        const double z = n_ * w[path_[3]], y = z + n_ * w[path_[2]];
        return {y + n_ * w[path_[1]], y, z};
    }

    /// Where the line passes one of the planes, with its ends, in order.
    void find_stops(Vec3d from, Vec3d way) {
        stops_.assign({0, 1});
        const auto add = [&](double a, double by) {
            const double low = std::min(a, a + by), high = std::max(a, a + by);
            for (double k = std::ceil(low); k <= high; ++k) {
                const double t = (k - a) / by;
                if (t > 0 && t < 1) stops_.push_back(t);
            }
        };
        add(from.x, way.x);
        add(from.y, way.y);
        add(from.z, way.z);
        add(from.x - from.y, way.x - way.y);
        add(from.y - from.z, way.y - way.z);
        add(from.x - from.z, way.x - way.z);
        std::ranges::sort(stops_);
    }

    /// Between two points of one fine tetrahedron, which is that of the point halfway.
    template <class Use>
    void visit_piece(Vec3d a, Vec3d b, const Use& use) const {
        const Vec3d middle = 0.5 * (a + b);
        std::array<int, 3> corner{};
        std::array<double, 3> rest{};
        for (int axis = 0; axis < 3; ++axis) {
            // Coordinates fall along the path and stay below n, but for rounding.
            const int most = axis == 0 ? n_ - 1 : corner[static_cast<std::size_t>(axis) - 1];
            const int whole = std::clamp(static_cast<int>(std::floor(middle[axis])), 0, most);
            corner[static_cast<std::size_t>(axis)] = whole;
            rest[static_cast<std::size_t>(axis)] = middle[axis] - whole;
        }
        // From the corner along the axes in the order of what is left; of equal ones the first, which stays
        // inside.
        std::array<int, 3> order{0, 1, 2};
        const auto put_first = [&](std::size_t i, std::size_t j) {
            if (rest[static_cast<std::size_t>(order[j])] > rest[static_cast<std::size_t>(order[i])])
                std::swap(order[i], order[j]);
        };
        put_first(0, 1);
        put_first(1, 2);
        put_first(0, 1);
        std::array<Local, 4> vertex{local_[place(corner)]};
        Weights at_a{}, at_b{};
        double left_a = 1, left_b = 1;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto axis = static_cast<std::size_t>(order[i]);
            const double next_a = a[order[i]] - corner[axis], next_b = b[order[i]] - corner[axis];
            at_a[i] = left_a - next_a;
            at_b[i] = left_b - next_b;
            left_a = next_a;
            left_b = next_b;
        }
        at_a[3] = left_a;
        at_b[3] = left_b;
        for (std::size_t i = 0; i < 3; ++i) {
            ++corner[static_cast<std::size_t>(order[i])];
            vertex[i + 1] = local_[place(corner)];
        }
        for (std::size_t i = 0; i < 4; ++i) {
            Span greatest;
            for (std::size_t j = 0; j < 4; ++j) {
                if (j != i) greatest.clip(at_a[i] - at_a[j], at_b[i] - at_b[j]);
            }
            if (!greatest.empty()) use(vertex[i]);
        }
    }

    int n_;
    std::array<std::uint8_t, 4> path_;
    std::vector<Local> local_;  ///< fine vertices by their coordinates
    std::vector<double> stops_;
};

Weights between(const Weights& a, const Weights& b, double part) {
    Weights out{};
    for (std::size_t i = 0; i < 4; ++i) out[i] = std::clamp(a[i] + (b[i] - a[i]) * part, 0.0, 1.0);
    return out;
}

/// Finds the held vertices of one region after the other.
class Holder {
  public:
    Holder(const TetraRefinement& refinement, const InsideAxes& axes) : refinement_(refinement), axes_(axes) {
        for (std::uint32_t d = 0; d < 3; ++d) lines_.emplace_back(refinement.pattern_along(d), d);
    }

    void find(std::uint32_t region, std::vector<HeldVertex>& out) {
        const auto passing = axes_.passing[region];
        if (passing.empty()) return;
        describe(region);
        for (const std::uint32_t s : passing) {
            const std::size_t begin = out.size();
            const Vec3d a(axes_.segments[s].a), b(axes_.segments[s].b), along = b - a;
            const double squared = length_squared(along), inverse = squared > 0 ? 1 / squared : 0;
            for (Coarse& c : coarse_) {
                const Vec3d w = c.middle - a;
                const double t = std::clamp(dot(w, along) * inverse, 0.0, 1.0);
                if (length_squared(w - along * t) > c.reach_squared) continue;
                if (!c.weights) c.weights.emplace(corners_of(c.tetra));
                look_at(c.tetra, c.weights->at(a), c.weights->at(b), s, begin, out);
            }
        }
    }

  private:
    /// A coarse tetrahedron, and a ball about it.
    struct Coarse {
        std::uint32_t tetra;
        Vec3d middle;
        double reach_squared;
        std::optional<WeightFunctions> weights;  ///< once an axis comes near
    };

    std::array<Vec3d, 4> corners_of(std::uint32_t t) const {
        std::array<Vec3d, 4> p;
        for (std::size_t i = 0; i < 4; ++i)
            p[i] = Vec3d(refinement_.coarse().positions[refinement_.parts(t)[i]]);
        return p;
    }

    void describe(std::uint32_t region) {
        coarse_.clear();
        const TetraMesh& mesh = refinement_.coarse();
        for (std::uint32_t t = mesh.first[region]; t < mesh.first[region + 1]; ++t) {
            const std::array<Vec3d, 4> p = corners_of(t);
            const Vec3d middle = 0.25 * (p[0] + p[1] + p[2] + p[3]);
            double reach = 0;
            for (const Vec3d c : p) reach = std::max(reach, length_squared(c - middle));
            coarse_.push_back({t, middle, (1 + kSlack) * reach, {}});
        }
    }

    /// Appends what the axis between two points of a coarse tetrahedron needs, and what is not in `out` from
    /// `begin` on.
    void look_at(std::uint32_t t, const Weights& start, const Weights& end, std::uint32_t segment,
                 std::size_t begin, std::vector<HeldVertex>& out) {
        const Span span = within(start, end);
        if (span.empty()) return;
        const auto hold = [&](Local local) {
            const std::uint32_t vertex = refinement_.vertex(t, local);
            const auto seen = std::span(out).subspan(begin);
            if (std::ranges::find(seen, vertex, &HeldVertex::vertex) == seen.end())
                out.push_back({vertex, segment, t, local});
        };
        lines_[refinement_.diagonal(t)].visit_greatest(between(start, end, span.from),
                                                       between(start, end, span.to), hold);
    }

    const TetraRefinement& refinement_;
    const InsideAxes& axes_;
    std::vector<FineLine> lines_;  ///< by diagonal
    std::vector<Coarse> coarse_;   ///< of one region
};

/// Ascending by vertex; of each, in the order of regions.
Buffer<HeldVertex> find_held(const TetraRefinement& refinement, const InsideAxes& axes, const Context& ctx) {
    constexpr std::size_t kRegions = 64;
    const std::size_t regions = refinement.coarse().region_count();
    std::vector<std::vector<HeldVertex>> found((regions + kRegions - 1) / kRegions);
    parallel_for_ranges(ctx, regions, kRegions, [&](IndexRange range) {
        if (ctx.stop.stop_requested()) return;
        Holder holder(refinement, axes);
        for (std::size_t r = range.begin; r < range.end; ++r)
            holder.find(static_cast<std::uint32_t>(r), found[r / kRegions]);
    });
    ctx.throw_if_cancelled();
    Buffer<HeldVertex> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    radix_sort(ctx, all, static_cast<unsigned>(std::bit_width(refinement.vertex_count())),
               [](const HeldVertex& h) { return h.vertex; });
    return all;
}

}  // namespace

HeldVertices hold_axes(const TetraRefinement& refinement, const InsideAxes& axes, const Context& ctx) {
    HeldVertices out{RankedBits(refinement.vertex_count()), {}, {}};
    if (axes.segments.empty()) return out;
    const Buffer<HeldVertex> found = find_held(refinement, axes, ctx);
    DisjointSets sets(axes.segments.size());
    for (std::size_t i = 0; i < found.size();) {
        const HeldVertex& first = found[i];
        const Vec3d place(refinement.position(first.tetra, first.local));
        const auto away = [&](std::uint32_t segment) {
            const Segment& s = axes.segments[segment];
            const Vec3d a(s.a), along = Vec3d(s.b) - a;
            return length_squared(a + along * closest_parameter(place, a, along) - place);
        };
        HeldVertex nearest = first;
        double least = away(first.segment);
        for (++i; i < found.size() && found[i].vertex == first.vertex; ++i) {
            sets.join(first.segment, found[i].segment);
            const double d = away(found[i].segment);
            if (d > least || (d == least && found[i].segment >= nearest.segment)) continue;
            least = d;
            nearest.segment = found[i].segment;
        }
        out.bits.set(first.vertex);
        out.list.push_back(nearest);
    }
    std::vector<std::uint8_t> seen(axes.segments.size());
    for (std::uint32_t i = 0; i < out.list.size(); ++i) {
        std::uint8_t& named = seen[sets.find(out.list[i].segment)];
        if (named == 0) out.of_each_set.push_back(i);
        named = 1;
    }
    return out;
}

}  // namespace coppice::tetra_internal
