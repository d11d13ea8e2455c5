#include "coppice/pipeline/fit_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/measure/union_volume.h"
#include "coppice/mesh/shape.h"
#include "coppice/pipeline/fit/fit_volume_internal.h"
#include "coppice/pipeline/fit/local_radii_internal.h"

namespace coppice {
namespace {

using pipeline_internal::area_vector;
using pipeline_internal::CrossingSearch;

constexpr std::size_t kFitVolumeGrain = 2048;
constexpr double kMaxGap = 0.35;       // [radii] larger gaps inside are not errors of the fit
constexpr double kMaxSwelling = 0.15;  // [radii] nor larger ones outside, where faces span forks
constexpr double kMaxOffset = 0.08;    // [radii] limit per vertex, in addition to twice the mean
constexpr double kMaxCoarse = 0.25;    // [radii] mean of a surface of four sides
constexpr int kMaxSteps = 3;
constexpr double kDone = 2e-3;   // share of the volume that ends the steps
constexpr double kExact = 5e-4;  // relative error of the volume after limiting offsets

/// Quantities that are spread over the surface: the volume that is missing at a vertex, and the volume that
/// it gains when it moves by the local radius.
struct Need {
    double volume = 0;
    double per_radius = 0;
    friend Need operator+(Need a, Need b) { return {a.volume + b.volume, a.per_radius + b.per_radius}; }
    friend Need operator*(Need a, double s) { return {a.volume * s, a.per_radius * s}; }
};

/// An edge of an open base, with a disc around a center in its plane.
struct OpenEdge {
    std::uint32_t from, to;
    Vec3d center;
};

struct Fit {
    PolygonMesh start;
    CompressedRows<std::uint32_t> faces_of;
    const Skeleton& skeleton;
    const ConeUnion& solid;
    const CrossingSearch& search;
    const Context& ctx;

    std::vector<std::uint32_t> capsule;  // per vertex: segment of its bark; kNoIndex: it does not move
    std::vector<std::uint32_t> cut;      // per vertex: the flat end that contains it, or kNoIndex
    std::vector<std::uint8_t> flat;      // per face: within a flat end
    std::vector<OpenEdge> open;
    std::vector<Vec3> direction;     // per vertex, unit or shorter
    std::vector<float> radius;       // per vertex
    std::vector<float> offset;       // [m] per vertex, along its direction
    std::vector<std::uint8_t> held;  // per vertex: was limited, does not move again
    Buffer<Vec3> positions;          // current positions

    std::size_t vertex_count() const { return start.positions.size(); }
    std::uint32_t face_count() const { return start.face_count(); }
    pipeline_internal::MovingSurface moving() const { return {start, faces_of, direction, search}; }
};

/// Returns the flat end that contains a point in its plane, within the rounding error.
std::uint32_t cut_at(const ConeUnion& solid, std::uint32_t capsule, Vec3d p) {
    constexpr double kNear = 2e-3, kReach = 3;  // [radii]
    for (const std::uint32_t k : solid.compute_cuts(capsule)) {
        const ConeUnion::Cut& cut = solid.cuts()[k];
        const Vec3d w = p - cut.center;
        if (std::fabs(dot(w, cut.outward)) < kNear * cut.radius && length(w) < kReach * cut.radius) return k;
    }
    return kNoIndex;
}

void find_flat_ends(Fit& fit) {
    fit.cut.assign(fit.vertex_count(), kNoIndex);
    fit.flat.assign(fit.face_count(), 0);
    if (!fit.solid.has_cuts()) return;
    parallel_for(fit.ctx, fit.vertex_count(), kFitVolumeGrain, [&](std::size_t v) {
        if (fit.capsule[v] == kNoIndex) return;
        fit.cut[v] = cut_at(fit.solid, fit.capsule[v], Vec3d(fit.start.positions[v]));
    });
    std::vector<std::array<std::uint32_t, 3>> edges;  // smaller end, larger end, cut: in the plane, one way
    std::vector<std::array<std::uint32_t, 3>> back;
    for (std::uint32_t f = 0; f < fit.face_count(); ++f) {
        const auto face = fit.start.face(f);
        const auto in_plane = [&](std::uint32_t v) { return fit.cut[v] != kNoIndex; };
        if (std::ranges::none_of(face, in_plane)) continue;
        const std::uint32_t k = fit.cut[face[0]];
        fit.flat[f] = k != kNoIndex && std::ranges::all_of(face, [&](auto v) { return fit.cut[v] == k; });
        for (std::size_t i = 0; i < face.size(); ++i) {
            const std::uint32_t a = face[i], b = face[(i + 1) % face.size()];
            if (!in_plane(a) || fit.cut[a] != fit.cut[b]) continue;
            edges.push_back({a, b, fit.cut[a]});
            back.push_back({b, a, fit.cut[a]});
        }
    }
    std::ranges::sort(edges);
    std::ranges::sort(back);
    std::vector<std::array<std::uint32_t, 3>> unpaired;
    std::ranges::set_difference(edges, back, std::back_inserter(unpaired));
    for (const auto& [a, b, k] : unpaired) fit.open.push_back({a, b, fit.solid.cuts()[k].center});
}

/// Returns the unit vector along which a vertex must not move: out of the plane of a flat end, and beyond a
/// tip along its branch, so that tips keep their reach; 0 elsewhere.
Vec3d held_direction(const Fit& fit, std::size_t v) {
    if (fit.cut[v] != kNoIndex) return fit.solid.cuts()[fit.cut[v]].outward;
    const CapsuleTree& capsules = fit.solid.capsules();
    if (fit.capsule[v] == kNoIndex || !fit.skeleton.is_tip(capsules.node(fit.capsule[v]))) return {};
    const RoundCone& cone = capsules.cone(fit.capsule[v]);
    if (cone.line_parameter(Vec3d(fit.start.positions[v])) <= 1) return {};
    return normalized(cone.axis, {0, 0, 0});
}

/// Returns the sum of the area vectors of a vertex's faces that are not flat ends.
Vec3d area_about(const Fit& fit, std::size_t v) {
    Vec3d sum;
    for (const std::uint32_t f : fit.faces_of[v]) {
        if (!fit.flat[f]) sum += area_vector(fit.start.face(f), fit.positions);
    }
    return sum;
}

/// Every vertex moves along its normal, without the component along the held direction, so that a vertex at
/// the very end of a tip does not move.
void find_directions(Fit& fit) {
    fit.direction.resize(fit.vertex_count());
    parallel_for(fit.ctx, fit.vertex_count(), kFitVolumeGrain, [&](std::size_t v) {
        if (fit.capsule[v] == kNoIndex) return;
        const Vec3d normal = normalized(area_about(fit, v), {0, 0, 0}), held = held_direction(fit, v);
        fit.direction[v] = Vec3(normal - held * dot(normal, held));
    });
}

double volume(const Fit& fit) {
    const auto six_times = [&](std::span<const std::uint32_t> face) {
        double sum = 0;
        for_each_triangle(face, fit.positions, [&](const Triangle& t) {
            sum += dot(Vec3d(fit.positions[t[0]]),
                       cross(Vec3d(fit.positions[t[1]]), Vec3d(fit.positions[t[2]])));
        });
        return sum;
    };
    double sum = parallel_reduce(
        fit.ctx, fit.face_count(), kFitVolumeGrain, 0.0,
        [&](IndexRange range) {
            double part = 0;
            for (std::size_t f = range.begin; f < range.end; ++f) {
                part += six_times(fit.start.face(static_cast<std::uint32_t>(f)));
            }
            return part;
        },
        std::plus<>());
    for (const OpenEdge& e : fit.open) {
        sum += dot(e.center, cross(Vec3d(fit.positions[e.to]), Vec3d(fit.positions[e.from])));
    }
    return sum / 6;
}

/// Returns the distance from p along the unit vector n to the bark of a cone, which is approximated as
/// circular around the closest point.
double gap_to(const RoundCone& cone, Vec3d p, Vec3d n) {
    constexpr double kMinCosine = 0.2;
    const RoundCone::ClosestPoint closest = cone.closest_point(p);
    const double d = closest.distance(), r = closest.radius, along = dot(n, closest.offset);
    const double under_root = along * along + r * r - d * d;
    double way = 0;
    if (along > 0 && under_root >= 0) {
        way = std::sqrt(under_root) - along;
    } else if (along > kMinCosine * d) {
        way = (r - d) * d / along;
    }
    return std::clamp(way, -kMaxGap * r, kMaxGap * r);
}

/// Returns the segment of these vertices that is closest to a point.
std::uint32_t capsule_at(const Fit& fit, std::span<const std::uint32_t> vertices, Vec3d p) {
    std::uint32_t best = kNoIndex;
    double least = 0;
    for (const std::uint32_t v : vertices) {
        const std::uint32_t i = fit.capsule[v];
        if (i == kNoIndex || i == best) continue;
        const double there = fit.solid.capsules().cone(i).closest_point(p).relative_squared();
        if (best != kNoIndex && there >= least) continue;
        least = there;
        best = i;
    }
    return best;
}

/// Returns the volume between a triangle of a face and the cones: exact if the gap is quadratic.
double missing_at(const Fit& fit, const Triangle& t, std::span<const double> gap_of_vertex) {
    constexpr double kShareOfMiddle = 0.75;
    const Vec3d area = area_vector(t, fit.positions);
    const double size = length(area);
    Vec3d middle;
    double of_corners = 0;
    for (const std::uint32_t v : t) {
        middle += Vec3d(fit.positions[v]) / 3;
        of_corners += gap_of_vertex[v] / 3;
    }
    const std::uint32_t i = capsule_at(fit, t, middle);
    if (!(size > 0) || i == kNoIndex) return 0;
    const double of_middle = std::max(gap_to(fit.solid.capsules().cone(i), middle, area / size),
                                      -kMaxSwelling * double{fit.radius[t[0]]});
    return size * (kShareOfMiddle * of_middle + (1 - kShareOfMiddle) * of_corners);
}

std::vector<double> gaps_of_vertices(const Fit& fit) {
    std::vector<double> gap(fit.vertex_count(), 0.0);
    parallel_for(fit.ctx, gap.size(), kFitVolumeGrain, [&](std::size_t v) {
        if (fit.capsule[v] == kNoIndex) return;
        const RoundCone& cone = fit.solid.capsules().cone(fit.capsule[v]);
        gap[v] = gap_to(cone, Vec3d(fit.positions[v]), normalized(Vec3d(fit.direction[v]), {0, 0, 0}));
    });
    return gap;
}

/// Returns the volume that is gained if a vertex moves by its radius: its share is a third of its triangles'
/// area, a quarter of its quads' area.
double gain_at(const Fit& fit, std::size_t v) {
    if (fit.held[v] || fit.faces_of[v].empty()) return 0;
    const auto corners = static_cast<double>(fit.start.face(fit.faces_of[v][0]).size());
    const double area = dot(area_about(fit, v), Vec3d(fit.direction[v]));
    return std::max(0.0, area) / corners * double{fit.radius[v]};
}

std::vector<Need> find_needs(const Fit& fit) {
    const std::vector<double> gap = gaps_of_vertices(fit);
    std::vector<double> missing(fit.face_count(), 0.0);
    parallel_for(fit.ctx, missing.size(), kFitVolumeGrain, [&](std::size_t f) {
        if (fit.flat[f]) return;
        for_each_triangle(fit.start.face(static_cast<std::uint32_t>(f)), fit.positions,
                          [&](const Triangle& t) { missing[f] += missing_at(fit, t, gap); });
    });
    std::vector<Need> needs(fit.vertex_count());
    parallel_for(fit.ctx, needs.size(), kFitVolumeGrain, [&](std::size_t v) {
        for (const std::uint32_t f : fit.faces_of[v]) {
            needs[v].volume += missing[f] / static_cast<double>(fit.start.face(f).size());
        }
        needs[v].per_radius = gain_at(fit, v);
    });
    return needs;
}

/// Every vertex distributes its value to its faces, and these to their corners.
void spread(const Fit& fit, std::vector<Need>& needs, std::vector<Need>& of_face) {
    parallel_for(fit.ctx, of_face.size(), kFitVolumeGrain, [&](std::size_t f) {
        const auto face = fit.start.face(static_cast<std::uint32_t>(f));
        Need sum;
        for (const std::uint32_t v : face) {
            sum = sum + needs[v] * (1 / static_cast<double>(fit.faces_of[v].size()));
        }
        of_face[f] = sum * (1 / static_cast<double>(face.size()));
    });
    parallel_for(fit.ctx, needs.size(), kFitVolumeGrain, [&](std::size_t v) {
        Need sum;
        for (const std::uint32_t f : fit.faces_of[v]) sum = sum + of_face[f];
        needs[v] = sum;
    });
}

Need compute_sum(std::span<const Need> needs) {
    Need sum;
    for (const Need& n : needs) sum = sum + n;
    return sum;
}

void move(Fit& fit, const std::function<double(std::size_t)>& radii) {
    parallel_for(fit.ctx, fit.vertex_count(), kFitVolumeGrain, [&](std::size_t v) {
        if (!fit.held[v]) fit.offset[v] += static_cast<float>(radii(v) * double{fit.radius[v]});
    });
    pipeline_internal::apply_offsets(fit.moving(), fit.offset, fit.positions, fit.ctx);
}

/// Returns the number of spreading passes for a distance of about one radius: a pass spreads by the length of
/// an edge, and the distance grows with the root of their number.
int passes(const Fit& fit, std::span<const Need> needs) {
    constexpr double kPassesPerSquareRadius = 2, kMaxPasses = 60, kMaxVertices = 100;
    const double squares = parallel_reduce(
        fit.ctx, needs.size(), kFitVolumeGrain, 0.0,
        [&](IndexRange range) {
            double part = 0;
            for (std::size_t v = range.begin; v < range.end; ++v) {
                const double r = fit.radius[v], cube = r * r * r;
                if (needs[v].per_radius > 0) part += std::min(kMaxVertices, cube / needs[v].per_radius);
            }
            return part;
        },
        std::plus<>());
    const double mean = squares / static_cast<double>(std::max<std::size_t>(1, needs.size()));
    return static_cast<int>(std::lround(std::clamp(kPassesPerSquareRadius * mean, 1.0, kMaxPasses)));
}

/// Moves the vertices by the missing volume around them; returns its total, and the displacement in radii
/// that would add it if it were the same for all vertices.
struct Step {
    double volume = 0, radii = 0;
};
Step step(Fit& fit) {
    std::vector<Need> needs = find_needs(fit), of_face(fit.face_count());
    const Need all = compute_sum(needs);
    if (!(all.per_radius > 0)) return {};
    for (int left = passes(fit, needs); left > 0; --left) {
        fit.ctx.throw_if_cancelled();
        spread(fit, needs, of_face);
    }
    const Step done{all.volume, all.volume / all.per_radius};
    const double most = kMaxOffset + 2 * std::min(std::fabs(done.radii), kMaxCoarse);
    move(fit, [&](std::size_t v) {
        if (!(needs[v].per_radius > 0)) return 0.0;
        const double so_far = double{fit.offset[v]} / double{fit.radius[v]};
        const double radii = needs[v].volume / needs[v].per_radius;
        return std::clamp(so_far + radii, std::min(so_far, -most), std::max(so_far, most)) - so_far;
    });
    return done;
}

/// Fits all sections; returns the coarseness of the surface: the number of radii by which it had to grow in
/// the first step.
double fit_parts(Fit& fit, double cones) {
    const Step first = step(fit);
    Step last = first;
    for (int k = 1; k < kMaxSteps && std::fabs(last.volume) > kDone * cones; ++k) last = step(fit);
    return first.radii;
}

/// Moves all vertices by the same share of their radius.
void close(Fit& fit, double cones) {
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
        const double missing = cones - volume(fit);
        if (std::fabs(missing) < kExact / 10 * cones) return;
        const double gain = parallel_reduce(
            fit.ctx, fit.vertex_count(), kFitVolumeGrain, 0.0,
            [&](IndexRange range) {
                double part = 0;
                for (std::size_t v = range.begin; v < range.end; ++v) part += gain_at(fit, v);
                return part;
            },
            std::plus<>());
        if (!(gain > 0)) return;
        move(fit, [&](std::size_t) { return missing / gain; });
    }
}

/// Returns whether the surface contains all sections of the cones, and few of them twice. If cross-sections
/// had to grow by a share of the radius, the expected volume is smaller by approximately its square.
bool is_whole(const Fit& fit, const FitVolumeReport& report, double coarseness) {
    constexpr double kUnexplained = 0.05, kTwice = 0.1;  // of the volume
    const double explained = (1 - coarseness) * (1 - coarseness) - coarseness / 4;
    return report.before >= (explained - kUnexplained) * report.cones &&
           volume(fit) <= (1 + kTwice) * report.cones;
}

void pull_back(Fit& fit) {
    constexpr std::uint32_t kHalvings = 4;
    const std::vector<float> wanted = fit.offset;
    pipeline_internal::limit_offsets(fit.moving(), fit.offset, kHalvings, fit.ctx);
    for (std::size_t v = 0; v < wanted.size(); ++v) {
        if (wanted[v] != fit.offset[v]) fit.held[v] = 1;
    }
    pipeline_internal::apply_offsets(fit.moving(), fit.offset, fit.positions, fit.ctx);
}

/// Reduces all displacements by the factor that results in the volume, which is between the volumes without
/// and with them.
void reduce_offsets(Fit& fit, double before, double cones) {
    constexpr int kHalvings = 20;
    const std::vector<float> full = fit.offset;
    double low = 0, high = 1;
    for (int k = 0; k < kHalvings; ++k) {
        const double share = 0.5 * (low + high);
        std::ranges::transform(full, fit.offset.begin(),
                               [&](float offset) { return static_cast<float>(share) * offset; });
        pipeline_internal::apply_offsets(fit.moving(), fit.offset, fit.positions, fit.ctx);
        ((volume(fit) < cones) == (before < cones) ? low : high) = share;
    }
    pull_back(fit);
}

void report_offsets(const Fit& fit, FitVolumeReport& report) {
    for (std::size_t v = 0; v < fit.vertex_count(); ++v) {
        report.pulled_back += fit.held[v];
        if (!(fit.radius[v] > 0)) continue;
        const double radii = double{fit.offset[v]} / double{fit.radius[v]};
        report.mean_offset += radii / static_cast<double>(fit.vertex_count());
        report.max_offset = std::max(report.max_offset, std::fabs(radii));
    }
}

FitVolumeReport fit_polygons(PolygonMesh start, Buffer<Vec3>& positions, const Skeleton& skeleton,
                             const ConeUnion& solid, const CrossingSearch& search, const Context& ctx) {
    FitVolumeReport report;
    const UnionVolume cones = union_volume(solid, {}, {}, narrow_progress(ctx, 0, 0.3f));
    report.cones = cones.total;
    report.error = cones.error;
    auto faces_of = pipeline_internal::faces_by_vertex(start);
    Fit fit{.start = std::move(start),
            .faces_of = std::move(faces_of),
            .skeleton = skeleton,
            .solid = solid,
            .search = search,
            .ctx = ctx};
    fit.positions = fit.start.positions;
    fit.offset.assign(fit.vertex_count(), 0);
    fit.held.assign(fit.vertex_count(), 0);
    pipeline_internal::LocalRadii local =
        pipeline_internal::find_local_radii(fit.start, fit.faces_of, skeleton, solid.capsules(), ctx);
    fit.capsule = std::move(local.capsule);
    fit.radius = std::move(local.radius);
    find_flat_ends(fit);
    find_directions(fit);
    ctx.report(0.5f);
    report.before = volume(fit);
    const double coarseness = fit_parts(fit, report.cones);
    ctx.report(0.7f);
    const auto is_near = [&](double part) {
        return std::fabs(volume(fit) - report.cones) <= part * report.cones;
    };
    report.closed = is_whole(fit, report, coarseness);
    if (report.closed) close(fit, report.cones);
    pull_back(fit);
    for (int k = 0; k < kMaxSteps && report.closed && !is_near(kExact); ++k) {
        close(fit, report.cones);
        pull_back(fit);
    }
    // Where chords between few vertices cut corners, sections may move too far.
    if (!is_near(kExact) && (volume(fit) < report.cones) != (report.before < report.cones))
        reduce_offsets(fit, report.before, report.cones);
    report.after = volume(fit);
    report_offsets(fit, report);
    positions = std::move(fit.positions);
    ctx.report(1);
    return report;
}

}  // namespace

FitVolumeReport fit_volume(QuadMesh& mesh, const Skeleton& skeleton, EndShape base, EndShape tips,
                           const Context& ctx) {
    return pipeline_internal::fit_volume(mesh, skeleton, base, tips, pipeline_internal::all_crossings, ctx);
}

FitVolumeReport pipeline_internal::fit_volume(QuadMesh& mesh, const Skeleton& skeleton, EndShape base,
                                              EndShape tips, const CrossingSearch& search,
                                              const Context& ctx) {
    const ConeUnion solid(skeleton, mesh.origin, base, tips, ctx);
    return fit_polygons(to_polygons(mesh), mesh.positions, skeleton, solid, search, ctx);
}

FitVolumeReport fit_volume(TriMesh& mesh, const Skeleton& skeleton, EndShape base, EndShape tips,
                           const Context& ctx) {
    const ConeUnion solid(skeleton, mesh.origin, base, tips, ctx);
    return fit_polygons(to_polygons(mesh), mesh.positions, skeleton, solid, pipeline_internal::all_crossings,
                        ctx);
}

}  // namespace coppice
