#include "coppice/extract/stem/stem_search_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <tuple>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/median.h"
#include "coppice/base/parallel.h"

namespace coppice::extract_internal {
namespace {

constexpr double kLow = 0.3;
constexpr double kSlice = 0.2;  // [m] height of the lowest slice above the ground; thickness of a slice
constexpr std::size_t kSlices = 18;
// [slice] thickness for clusters of few points; the second one is for clouds in which no stem was found
constexpr double kThickSlice = 3, kThickestSlice = 5;
// maximum number of points of a cluster for which a thick slice is used
constexpr std::size_t kFewPoints = 80;
constexpr double kThinSlice = 0.25;    // [slice] thickness for leaning stems
constexpr double kThin = 0.01;         // [m] edge of the squares in which one point is kept
constexpr double kLink = 0.08;         // [m] edge of the squares of a cluster; adjacent squares are connected
constexpr std::size_t kMinPoints = 8;  // minimum number of points of a cluster
constexpr int kMaxCircles = 12;        // maximum number of circles in a cluster
constexpr double kMaxInside = 0.5;     // maximum number of points inside a circle per point on it
constexpr double kShift = 0.06;        // [m] maximum shift between sections, in addition to the lean
constexpr double kLean = 0.8;          // maximum shift of the axis per height
constexpr double kRatio = 1.5;         // maximum ratio of the radii of sections
constexpr std::size_t kMinSections = 4;
constexpr double kMinSpan = 0.75;   // [m] minimum distance of the lowest and the highest section
constexpr double kSame = 0.95;      // [sum of two radii] closer axes belong to the same stem
constexpr double kLowestEnd = 1.4;  // [m] maximum height of the lowest section

struct Section {
    std::size_t slice;
    double x, y, z;
    FoundCircle circle;
};

/// Returns the clusters of points in a slice: connected squares.
std::vector<std::vector<PlanePoint>> find_clusters(const std::vector<PlanePoint>& points) {
    struct Place {
        std::int64_t i, j;
        std::uint32_t index;
        auto operator<=>(const Place&) const = default;
    };
    std::vector<Place> places;
    for (std::uint32_t k = 0; k < points.size(); ++k) {
        places.push_back({static_cast<std::int64_t>(std::floor(points[k].x / kLink)),
                          static_cast<std::int64_t>(std::floor(points[k].y / kLink)), k});
    }
    std::ranges::sort(places);
    DisjointSets sets(points.size());
    const auto first_at = [&](std::int64_t i, std::int64_t j) {
        return std::ranges::lower_bound(places, Place{i, j, 0});
    };
    for (const Place& p : places) {
        for (const auto& [di, dj] : {std::pair{0, 0}, {0, 1}, {1, -1}, {1, 0}, {1, 1}}) {
            const auto other = first_at(p.i + di, p.j + dj);
            if (other != places.end() && other->i == p.i + di && other->j == p.j + dj)
                sets.join(p.index, other->index);
        }
    }
    std::vector<std::vector<PlanePoint>> clusters(points.size());
    for (std::uint32_t k = 0; k < points.size(); ++k) clusters[sets.find(k)].push_back(points[k]);
    std::erase_if(clusters, [](const auto& c) { return c.size() < kMinPoints; });
    return clusters;
}

bool is_stem_like(const FoundCircle& c, double noise) {
    return c.used >= kMinPoints && c.inside <= kMaxInside && c.residual <= 0.15 * c.radius + noise;
}

/// Adds the circles of one cluster; the points of each circle are removed before the next search.
void add_circles(std::vector<PlanePoint> points, const StemSearch& search, std::uint64_t seed,
                 std::vector<FoundCircle>& out) {
    for (int k = 0; k < kMaxCircles && points.size() >= kMinPoints; ++k) {
        const FoundCircle c = find_circle(points, {.min_radius = search.min_radius,
                                                   .max_radius = search.max_radius,
                                                   .noise = search.noise,
                                                   .seed = seed + static_cast<std::uint64_t>(k)});
        if (c.used == 0) return;
        if (is_stem_like(c, search.noise)) out.push_back(c);
        const std::size_t before = points.size();
        std::erase_if(points, [&](const PlanePoint& p) {
            return std::hypot(p.x - c.x, p.y - c.y) < 1.1 * c.radius + 2 * search.noise;
        });
        if (points.size() == before) return;
    }
}

/// Returns the circles of all clusters; incomplete after a cancellation request.
std::vector<FoundCircle> find_circles(std::vector<std::vector<PlanePoint>> clusters, const StemSearch& search,
                                      std::uint64_t seed, const Context& ctx) {
    std::vector<FoundCircle> circles;
    for (auto& cluster : clusters) {
        if (ctx.stop.stop_requested()) break;
        add_circles(std::move(cluster), search, seed += 64, circles);
    }
    return circles;
}

/// Returns the sections in slices with the specified thicknesses.
std::vector<Section> compute_sections(std::span<const Vec3> points, std::span<const float> height,
                                      std::span<const double> thicknesses, const StemSearch& search,
                                      const Context& ctx) {
    std::vector<std::vector<std::uint32_t>> members(kSlices);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const double slice = (double{height[i]} / search.scale - kLow) / kSlice;
        if (slice >= 0 && slice < static_cast<double>(kSlices))
            members[static_cast<std::size_t>(slice)].push_back(i);
    }
    std::vector<std::vector<Section>> found(kSlices);
    parallel_for(ctx, kSlices, 1, [&](std::size_t s) {
        const double middle = (kLow + (static_cast<double>(s) + 0.5) * kSlice) * search.scale;
        for (const double share : thicknesses) {
            const double reach = 0.5 * share * kSlice * search.scale;
            std::vector<PlanePoint> plane;
            const auto adjacent = static_cast<std::size_t>(0.5 * std::max(share - 1, 0.0));
            for (std::size_t k = s - std::min(s, adjacent); k <= std::min(s + adjacent, kSlices - 1); ++k) {
                for (const std::uint32_t i : members[k]) {
                    if (std::abs(double{height[i]} - middle) <= reach)
                        plane.push_back({points[i].x, points[i].y, 1});
                }
            }
            auto clusters = find_clusters(thin_plane(plane, kThin * search.scale));
            if (share > 1) std::erase_if(clusters, [](const auto& c) { return c.size() > kFewPoints; });
            const auto circles = find_circles(std::move(clusters), search, std::uint64_t{s} << 32, ctx);
            for (const FoundCircle& c : circles) found[s].push_back({s, c.x, c.y, middle, c});
        }
    });
    ctx.throw_if_cancelled();
    std::vector<Section> all;
    for (const auto& slice : found) all.insert(all.end(), slice.begin(), slice.end());
    return all;
}

/// Returns the sections above a first one that may form a stem with it: of each slice the section of similar
/// thickness closest to the extrapolated axis. Up to two slices may be missing. Several stacks may share a
/// section, so that they do not interrupt each other; the stems among them are selected later.
std::vector<std::size_t> stack_from(std::size_t first, const std::vector<Section>& sections,
                                    const std::array<std::size_t, kSlices + 1>& slice, double scale) {
    std::vector<std::size_t> of{first};
    double dx = 0, dy = 0;  // lean of the axis
    for (std::size_t s = sections[first].slice + 1; s < kSlices && s - sections[of.back()].slice <= 3; ++s) {
        const Section& end = sections[of.back()];
        const double rise = static_cast<double>(s - end.slice) * kSlice * scale;
        double least = kShift + 0.25 * end.circle.radius + (of.size() > 1 ? 0.3 : 0.5) * rise;
        std::size_t best = sections.size();
        for (std::size_t k = slice[s]; k < slice[s + 1]; ++k) {
            const Section& next = sections[k];
            const double ratio = next.circle.radius / end.circle.radius;
            if (ratio > kRatio || ratio < 1 / kRatio) continue;
            const double off = std::hypot(next.x - end.x - dx * rise, next.y - end.y - dy * rise) +
                               0.5 * std::abs(next.circle.radius - end.circle.radius);
            if (off >= least) continue;
            least = off;
            best = k;
        }
        if (best == sections.size()) continue;
        const Section& next = sections[best];
        const double keep = of.size() > 1 ? 0.6 : 0;
        dx = std::clamp(keep * dx + (1 - keep) * (next.x - end.x) / rise, -kLean, kLean);
        dy = std::clamp(keep * dy + (1 - keep) * (next.y - end.y) / rise, -kLean, kLean);
        of.push_back(best);
    }
    return of;
}

std::vector<std::vector<std::size_t>> stack(const std::vector<Section>& sections, double scale) {
    std::array<std::size_t, kSlices + 1> slice{};
    for (const Section& s : sections) ++slice[s.slice + 1];
    std::partial_sum(slice.begin(), slice.end(), slice.begin());
    std::vector<std::vector<std::size_t>> out;
    for (std::size_t k = 0; k < sections.size(); ++k) out.push_back(stack_from(k, sections, slice, scale));
    return out;
}

/// Returns the root mean square distance of sections from the line between the previous and the next one.
double unevenness(const StemTrack& track) {
    double squares = 0, count = 0;
    for (std::size_t i = 1; i + 1 < track.sections.size(); ++i) {
        const Vec3d a = track.sections[i - 1].center, b = track.sections[i].center,
                    c = track.sections[i + 1].center;
        squares += length_squared(b - lerp(a, c, (b.z - a.z) / (c.z - a.z)));
        count += 1;
    }
    return count > 0 ? std::sqrt(squares / count) : 0;
}

bool is_stem(const StemTrack& track, double scale) {
    if (track.sections.size() < kMinSections) return false;
    const double span = track.sections.back().height - track.sections.front().height;
    if (span < kMinSpan * scale || track.sections.front().height > kLowestEnd * scale) return false;
    double coverage = 0;
    for (const StemSection& s : track.sections) coverage += s.circle.coverage;
    coverage /= static_cast<double>(track.sections.size());
    // A few sections must have good coverage; many sections are sufficient on their own.
    const double evidence = coverage * static_cast<double>(track.sections.size());
    const Vec3d along = track.sections.back().center - track.sections.front().center;
    return evidence >= 2 && unevenness(track) <= 0.25 * track.radius + 0.02 &&
           std::hypot(along.x, along.y) <= kLean * along.z;
}

/// Returns the slope of the least-squares line through the centres of the sections.
Vec3d compute_slope(std::span<const StemSection> sections) {
    Vec3d middle;
    for (const StemSection& s : sections) middle += s.center / static_cast<double>(sections.size());
    double zz = 0;
    Vec3d slope{0, 0, 1};
    for (const StemSection& s : sections) zz += (s.center.z - middle.z) * (s.center.z - middle.z);
    for (const StemSection& s : sections) {
        const Vec3d off = s.center - middle;
        slope += Vec3d{off.x, off.y, 0} * (zz > 0 ? off.z / zz : 0);
    }
    return slope;
}

/// Returns the stems among the sections, those with the largest evidence first.
std::vector<StemTrack> select_stems(const std::vector<Section>& sections, const StemSearch& search) {
    std::vector<StemTrack> stems;
    for (const auto& of : stack(sections, search.scale)) {
        StemTrack track;
        std::vector<double> radii;
        for (const std::size_t k : of) {
            const Section& s = sections[k];
            track.sections.push_back({{s.x, s.y, s.z}, s.z, s.circle});
            radii.push_back(s.circle.radius);
        }
        if (of.size() < 2) continue;
        track.radius = median_in_place(radii);
        if (is_stem(track, search.scale)) stems.push_back(std::move(track));
    }
    std::ranges::stable_sort(stems, std::ranges::greater{}, [](const StemTrack& t) {
        double evidence = 0;
        for (const StemSection& s : t.sections) evidence += s.circle.coverage;
        return evidence;
    });
    // A stem may be found twice, in thick slices and in thin ones.
    std::vector<StemTrack> apart;
    for (StemTrack& stem : stems) {
        const auto is_same = [&](const StemTrack& other) {
            const Vec3d at = other.at(stem.middle().z), here = stem.middle();
            return std::hypot(at.x - here.x, at.y - here.y) < kSame * (other.radius + stem.radius);
        };
        if (std::ranges::none_of(apart, is_same)) apart.push_back(std::move(stem));
    }
    return apart;
}

constexpr std::size_t kAbout = 5;  // number of sections that determine the direction of the axis

}  // namespace

Vec3d StemTrack::direction_at(double z) const {
    const auto after =
        std::ranges::lower_bound(sections, z, {}, [](const StemSection& s) { return s.center.z; });
    const auto place = static_cast<std::size_t>(after - sections.begin());
    const std::size_t count = std::min(kAbout, sections.size());
    const std::size_t first = std::min(place - std::min(place, (count + 1) / 2), sections.size() - count);
    return normalized(compute_slope(std::span(sections).subspan(first, count)));
}

Vec3d StemTrack::at(double z) const {
    const auto after =
        std::ranges::lower_bound(sections, z, {}, [](const StemSection& s) { return s.center.z; });
    if (after != sections.begin() && after != sections.end()) {
        const Vec3d a = (after - 1)->center, b = after->center;
        return lerp(a, b, (z - a.z) / (b.z - a.z));
    }
    const Vec3d end = after == sections.begin() ? sections.front().center : sections.back().center;
    const Vec3d along = direction_at(z);
    return end + along * ((z - end.z) / along.z);
}

void StemTrack::raise(double by) {
    for (StemSection& s : sections) s.center.z += by;
}

std::vector<StemTrack> find_stems(std::span<const Vec3> points, std::span<const float> height,
                                  const StemSearch& search, const Context& ctx) {
    // Whole slices, thin ones for leaning stems, and thick ones where there are few points.
    std::vector<double> thicknesses{1, kThinSlice, kThickSlice};
    std::vector<StemTrack> stems =
        select_stems(compute_sections(points, height, thicknesses, search, ctx), search);
    if (!stems.empty()) return stems;
    thicknesses.push_back(kThickestSlice);
    return select_stems(compute_sections(points, height, thicknesses, search, ctx), search);
}

std::vector<FoundCircle> circles_in_slice(std::span<const Vec3> points, const StemSearch& search,
                                          const Context& ctx) {
    std::vector<PlanePoint> plane;
    for (const Vec3 p : points) plane.push_back({p.x, p.y, 1});
    auto circles = find_circles(find_clusters(thin_plane(plane, kThin * search.scale)), search, 0, ctx);
    ctx.throw_if_cancelled();
    std::ranges::stable_sort(circles, std::ranges::greater{}, &FoundCircle::radius);
    return circles;
}

}  // namespace coppice::extract_internal
