#include "coppice/points/quality.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/base/random.h"
#include "coppice/base/sort.h"
#include "coppice/points/sampling/point_hash_internal.h"
#include "coppice/spatial/kd_tree.h"

namespace coppice {
namespace {

using points_internal::PointHash;

constexpr std::uint64_t kStage = 0x7175616c;
constexpr double kMaxPairs = 1e9;
constexpr std::uint32_t kLook = 256;  // number of points between two checks of the stop token

// Progress at the end of each stage.
constexpr float kDistances = 0.2f;
constexpr float kDistribution = 0.6f;

/// Returns the distinct points, sorted by x, then y, then z.
Buffer<Vec3> distinct(Buffer<Vec3> points, const Context& ctx) {
    for (int axis = 2; axis >= 0; --axis) {
        radix_sort(ctx, points, 32, [axis](Vec3 p) {
            // Sorted numerically; + 0.0f, because -0 and 0 are equal.
            const auto bits = std::bit_cast<std::uint32_t>(p[axis] + 0.0f);
            return bits >> 31 != 0 ? ~bits : bits | 1u << 31;
        });
    }
    points.erase(std::unique(points.begin(), points.end()), points.end());
    return points;
}

/// Coincident points count with distance 0; the closest other points are searched in a tree.
void measure_distances(const PointSet& set, QualityReport& report, const Context& ctx) {
    if (set.size() < 2) return;
    const Buffer<Vec3> points = distinct(set.positions, ctx);
    const bool doubled = points.size() < set.size();
    if (doubled && points.size() < 2) return;
    const KdTree tree(points, ctx);
    struct Sum {
        double least = std::numeric_limits<double>::infinity(), all = 0;
    };
    const auto part = [&](IndexRange range) {
        Sum sum;
        for (std::size_t i = range.begin; i < range.end; ++i) {
            std::array<std::uint32_t, 2> index;  // of the point itself, and of the closest other one
            std::array<double, 2> squared;
            tree.nearest(points[i], index, squared);
            const double d = std::sqrt(squared[1]);
            sum.least = std::min(sum.least, d);
            sum.all += d;
        }
        return sum;
    };
    const Sum sum = parallel_reduce(ctx, points.size(), 1024, Sum{}, part, [](Sum a, const Sum& b) {
        return Sum{std::min(a.least, b.least), a.all + b.all};
    });
    report.min_distance = doubled ? 0 : sum.least;
    report.mean_distance = sum.all / static_cast<double>(set.size());
}

bool contains(const Box3& box, Vec3 p) {
    return p.x >= box.low.x && p.x <= box.high.x && p.y >= box.low.y && p.y <= box.high.y &&
           p.z >= box.low.z && p.z <= box.high.z;
}

/// Returns a random subset of the points with a uniform probability: this changes neither curve except for
/// noise.
Buffer<Vec3> random_part(const Buffer<Vec3>& points, double share) {
    const CounterRandom random(1, kStage);
    Buffer<Vec3> out;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (random.uniform(i) < share) out.push_back(points[i]);
    }
    return out;
}

/// Returns the number of pairs that a grid with this edge would compare.
double pairs_in(const Buffer<Vec3>& points, double edge) {
    std::vector<std::array<std::int64_t, 3>> cells;
    cells.reserve(points.size());
    const auto cell = [edge](float x) { return static_cast<std::int64_t>(std::floor(x / edge)); };
    for (const Vec3 p : points) cells.push_back({cell(p.x), cell(p.y), cell(p.z)});
    std::sort(cells.begin(), cells.end());
    double pairs = 0;
    for (std::size_t i = 0; i < cells.size();) {
        std::size_t k = i;
        while (k < cells.size() && cells[k] == cells[i]) ++k;
        pairs += 27.0 * static_cast<double>(k - i) * static_cast<double>(k - i);
        i = k;
    }
    return pairs;
}

/// Measures pairs of which the first point is at least the reach away from the border of the window.
void measure_distribution(Buffer<Vec3> points, const Box3& window, const QualityOptions& options,
                          QualityReport& report, const Context& ctx) {
    const Vec3 size = window.size();
    const double shortest = std::min({size.x, size.y, size.z});
    const double reach = std::min(options.range * report.mean_spacing, 0.3 * shortest);
    const auto bins = static_cast<std::size_t>(options.bins);
    report.distance_step = reach / static_cast<double>(bins);
    for (double pairs = pairs_in(points, reach); pairs > kMaxPairs; pairs = pairs_in(points, reach)) {
        points = random_part(points, 0.9 * std::sqrt(kMaxPairs / pairs));
    }
    PointHash grid(reach, points.size());
    for (const Vec3 p : points) grid.insert(p);
    const Box3 inner = window.inflated(static_cast<float>(-reach));
    std::vector<double> count(bins);
    double centers = 0;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        if (i % kLook == 0) check_in(ctx, i, points.size());
        if (!contains(inner, points[i])) continue;
        ++centers;
        grid.visit(points[i], reach, [&](std::uint32_t n, double d2) {
            const auto bin = static_cast<std::size_t>(std::sqrt(d2) / report.distance_step);
            if (n != i && bin < bins) ++count[bin];
            return true;
        });
    }
    const double volume = static_cast<double>(size.x) * size.y * size.z;
    // number of pairs per cubic metre
    const double expected = centers * static_cast<double>(points.size()) / volume;
    report.distribution.resize(bins);
    for (std::size_t b = 0; b < bins; ++b) {
        const double r0 = report.distance_step * static_cast<double>(b), r1 = r0 + report.distance_step;
        const double shell = 4 * std::numbers::pi / 3 * (r1 * r1 * r1 - r0 * r0 * r0);
        report.distribution[b] = expected > 0 ? count[b] / (expected * shell) : 0;
    }
}

struct Weighted {
    Vec3d place;  ///< relative to the centre and the size of the window
    double weight;
};

/// Adds the power of the multiples of one frequency along one direction.
void add_power(const std::vector<Weighted>& points, const Vec3d& size, Vec3d frequency,
               std::vector<double>& power) {
    const std::size_t bins = power.size();
    std::vector<double> re(bins), im(bins);
    double total = 0, squares = 0;
    for (const Weighted& p : points) {
        total += p.weight;
        squares += p.weight * p.weight;
        const Vec3d x(p.place.x * size.x, p.place.y * size.y, p.place.z * size.z);
        const double angle = -2 * std::numbers::pi * dot(frequency, x);
        const double c = std::cos(angle), s = std::sin(angle);
        double a = p.weight, b = 0;
        for (std::size_t k = 0; k < bins; ++k) {
            const double next = a * c - b * s;
            b = a * s + b * c;
            a = next;
            re[k] += a;
            im[k] += b;
        }
    }
    // The transform of the weight itself, a raised cosine along each axis: the transform of a uniform
    // density.
    const auto window = [](double f) {
        if (std::abs(f) < 1e-9) return 1.0;
        if (std::abs(std::abs(f) - 1) < 1e-9) return 0.5;
        return std::sin(std::numbers::pi * f) / (std::numbers::pi * f * (1 - f * f));
    };
    for (std::size_t k = 0; k < bins; ++k) {
        const Vec3d f = frequency * static_cast<double>(k + 1);
        const double mean = total * window(f.x * size.x) * window(f.y * size.y) * window(f.z * size.z);
        const double real = re[k] - mean;
        power[k] += (real * real + im[k] * im[k]) / squares;
    }
}

void measure_power(const Buffer<Vec3>& points, const Box3& window, const QualityOptions& options,
                   QualityReport& report, const Context& ctx) {
    const Vec3d size(window.size()), middle = 0.5 * (Vec3d(window.low) + Vec3d(window.high));
    const auto bins = static_cast<std::size_t>(options.bins);
    const double nyquist = 1 / report.mean_spacing;
    report.frequency_step = options.range * nyquist / static_cast<double>(bins);
    std::vector<Weighted> weighted;
    const auto hann = [](double x) { return 0.5 + 0.5 * std::cos(2 * std::numbers::pi * x); };
    for (const Vec3 p : points) {
        const Vec3d d = Vec3d(p) - middle;
        const Vec3d x(d.x / size.x, d.y / size.y, d.z / size.z);
        weighted.push_back({x, hann(x.x) * hann(x.y) * hann(x.z)});
    }
    const auto directions = static_cast<std::size_t>(options.directions);
    const auto part = [&](IndexRange range) {
        std::vector<double> power(bins);
        for (std::size_t i = range.begin; i < range.end; ++i) {
            // Uniform directions on half the sphere, along a spiral.
            const double z = (static_cast<double>(i) + 0.5) / static_cast<double>(directions);
            const double turn = 2 * std::numbers::pi * std::numbers::phi * static_cast<double>(i);
            const double r = std::sqrt(1 - z * z);
            add_power(weighted, size,
                      Vec3d(r * std::cos(turn), r * std::sin(turn), z) * report.frequency_step, power);
        }
        return power;
    };
    report.power = parallel_reduce(ctx, directions, 4, std::vector<double>(bins), part,
                                   [](std::vector<double> a, const std::vector<double>& b) {
                                       for (std::size_t k = 0; k < a.size(); ++k) a[k] += b[k];
                                       return a;
                                   });
    double low = 0, count = 0;
    for (std::size_t k = 0; k < bins; ++k) {
        report.power[k] /= static_cast<double>(directions);
        if (static_cast<double>(k + 1) * report.frequency_step > nyquist / 2) continue;
        low += report.power[k];
        ++count;
    }
    report.low_power = count > 0 ? low / count : 0;
}

/// Returns the middle half of the box along each axis: inside most crowns, and away from their surface.
Box3 compute_middle(const Box3& box) {
    const Vec3 center = box.center(), quarter = 0.25f * box.size();
    return {center - quarter, center + quarter};
}

}  // namespace

QualityReport quality(const PointSet& points, const Box3& window, const QualityOptions& options,
                      const Context& ctx) {
    check_fields(options, "quality");
    if (!std::all_of(points.positions.begin(), points.positions.end(), [](Vec3 p) { return is_finite(p); })) {
        throw InvalidInput("quality: a point is not finite");
    }
    QualityReport report;
    report.points = points.size();
    measure_distances(points, report, ctx);
    ctx.report(kDistances);
    Buffer<Vec3> inside;
    for (const Vec3 p : points.positions) {
        if (contains(window, p)) inside.push_back(p);
    }
    const auto most = static_cast<double>(options.max_points);
    if (static_cast<double>(inside.size()) > most) {
        inside = random_part(inside, most / static_cast<double>(inside.size()));
    }
    const Vec3 size = window.size();
    const double volume = static_cast<double>(size.x) * size.y * size.z;
    if (inside.size() < 2 || !(volume > 0) || !std::isfinite(volume)) return report;
    report.mean_spacing = std::cbrt(volume / static_cast<double>(inside.size()));
    measure_distribution(inside, window, options, report, narrow_progress(ctx, kDistances, kDistribution));
    ctx.report(kDistribution);
    measure_power(inside, window, options, report, ctx);
    ctx.report(1);
    return report;
}

QualityReport quality(const PointSet& points, const QualityOptions& options, const Context& ctx) {
    return quality(points, compute_middle(bounds(points)), options, ctx);
}

void list_fields(QualityOptions& o, FieldList& list) {
    list.add(Field{"bins", "Number of bins of the curves.", Unit::none, 8, 1024}, o.bins);
    list.add(Field{"range", "Range of the curves, in mean spacings and in multiples of their frequency.",
                   Unit::none, 1, 16},
             o.range);
    list.add(
        Field{"directions", "Number of directions over which the power is averaged.", Unit::none, 8, 4096},
        o.directions);
    list.add(Field{"max_points",
                   "Maximum number of points for the curves; larger sets are represented by a random subset.",
                   Unit::none, 100, 1e6},
             o.max_points);
}

}  // namespace coppice
