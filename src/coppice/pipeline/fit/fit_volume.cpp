#include "coppice/pipeline/fit_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "coppice/base/parallel.h"
#include "coppice/base/progress.h"
#include "coppice/measure/union_volume.h"
#include "coppice/mesh/shape.h"
#include "coppice/pipeline/fit/fit_volume_internal.h"
#include "coppice/pipeline/fit/nearest_segment_internal.h"

namespace coppice {
namespace {

using pipeline_internal::area_vector;
using pipeline_internal::CrossingSearch;

constexpr std::size_t kFitVolumeGrain = 2048;
constexpr double kMostGap = 0.35;       // [radii] what is farther inside is no matter of fit
constexpr double kMostSwelling = 0.15;  // [radii] nor what is farther outside, where faces span forks
constexpr double kMostOffset = 0.08;    // [radii] of a vertex, beside twice the mean
constexpr double kMostCoarse = 0.25;    // [radii] mean of a surface of four sides
constexpr int kMostSteps = 3;
constexpr double kDone = 2e-3;   // of the volume, left to a step
constexpr double kExact = 5e-4;  // of the volume, as far as it is closed again after pulling back

/// What is spread over the surface: the volume that is missing at a vertex, and what it gains when it moves
/// by the local radius.
struct Need {
    double volume = 0;
    double per_radius = 0;
    friend Need operator+(Need a, Need b) { return {a.volume + b.volume, a.per_radius + b.per_radius}; }
    friend Need operator*(Need a, double s) { return {a.volume * s, a.per_radius * s}; }
};

/// An edge of an open base, whose disc is about a center in its plane.
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

    std::vector<std::uint32_t> capsule;  // per vertex: whose bark it is; kNone: it stays
    std::vector<std::uint32_t> cut;      // per vertex: the flat end in whose plane it lies, or kNoRow
    std::vector<std::uint8_t> flat;      // per face: within a flat end
    std::vector<OpenEdge> open;
    std::vector<Vec3> direction;     // per vertex, unit or shorter
    std::vector<float> radius;       // per vertex
    std::vector<float> offset;       // [m] per vertex, along its direction
    std::vector<std::uint8_t> held;  // per vertex: was pulled back, moves no more
    Buffer<Vec3> positions;          // now

    std::size_t vertex_count() const { return start.positions.size(); }
    std::uint32_t face_count() const { return start.face_count(); }
    pipeline_internal::MovingSurface moving() const { return {start, faces_of, direction, search}; }
};

void find_capsules(Fit& fit) {
    const pipeline_internal::NearestSegment nearest(fit.skeleton, fit.solid.capsules());
    fit.capsule.resize(fit.vertex_count());
    fit.radius.assign(fit.vertex_count(), 0);
    parallel_for_ranges(fit.ctx, fit.vertex_count(), kFitVolumeGrain, [&](IndexRange range) {
        std::uint32_t hint = CapsuleTree::kNone;
        for (std::size_t v = range.begin; v < range.end; ++v) {
            const Vec3d p(fit.start.positions[v]);
            fit.capsule[v] = hint = nearest(p, hint);
            if (hint == CapsuleTree::kNone) continue;
            fit.radius[v] = static_cast<float>(fit.solid.capsules().cone(hint).foot(p).radius);
        }
    });
}

/// Lets radii grow by no more than the distance along the surface, some faces far: vertices where a thin
/// branch leaves a thick one, which lie on the thick one, would move the thin one by a part of the other's
/// radius.
void limit_radii(Fit& fit) {
    constexpr int kFaces = 4;
    for (int pass = 0; pass < kFaces; ++pass) {
        std::vector<float> limited(fit.vertex_count());
        parallel_for(fit.ctx, limited.size(), kFitVolumeGrain, [&](std::size_t v) {
            limited[v] = fit.radius[v];
            for (const std::uint32_t f : fit.faces_of[v]) {
                for (const std::uint32_t w : fit.start.face(f)) {
                    if (fit.capsule[w] == CapsuleTree::kNone) continue;
                    limited[v] = std::min(
                        limited[v], fit.radius[w] + distance(fit.start.positions[v], fit.start.positions[w]));
                }
            }
        });
        fit.radius = std::move(limited);
    }
}

/// The flat end in whose plane a point lies, as far as rounding tells.
std::uint32_t cut_at(const ConeUnion& solid, std::uint32_t capsule, Vec3d p) {
    constexpr double kNear = 2e-3, kReach = 3;  // [radii]
    for (const std::uint32_t k : solid.cuts_of(capsule)) {
        const ConeUnion::Cut& cut = solid.cuts()[k];
        const Vec3d w = p - cut.center;
        if (std::fabs(dot(w, cut.outward)) < kNear * cut.radius && length(w) < kReach * cut.radius) return k;
    }
    return kNoRow;
}

void find_flat_ends(Fit& fit) {
    fit.cut.assign(fit.vertex_count(), kNoRow);
    fit.flat.assign(fit.face_count(), 0);
    if (!fit.solid.has_cuts()) return;
    parallel_for(fit.ctx, fit.vertex_count(), kFitVolumeGrain, [&](std::size_t v) {
        if (fit.capsule[v] == CapsuleTree::kNone) return;
        fit.cut[v] = cut_at(fit.solid, fit.capsule[v], Vec3d(fit.start.positions[v]));
    });
    std::vector<std::array<std::uint32_t, 3>> edges;  // lesser end, greater end, cut: in the plane, one way
    std::vector<std::array<std::uint32_t, 3>> back;
    for (std::uint32_t f = 0; f < fit.face_count(); ++f) {
        const auto face = fit.start.face(f);
        const auto in_plane = [&](std::uint32_t v) { return fit.cut[v] != kNoRow; };
        if (std::ranges::none_of(face, in_plane)) continue;
        const std::uint32_t k = fit.cut[face[0]];
        fit.flat[f] = k != kNoRow && std::ranges::all_of(face, [&](auto v) { return fit.cut[v] == k; });
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

/// The unit vector along which a vertex may not move: out of the plane of a flat end, and beyond a tip along
/// its branch, so that tips reach as far as before; 0 elsewhere.
Vec3d held_direction(const Fit& fit, std::size_t v) {
    if (fit.cut[v] != kNoRow) return fit.solid.cuts()[fit.cut[v]].outward;
    const CapsuleTree& capsules = fit.solid.capsules();
    if (fit.capsule[v] == CapsuleTree::kNone || !fit.skeleton.is_tip(capsules.node(fit.capsule[v])))
        return {};
    const RoundCone& cone = capsules.cone(fit.capsule[v]);
    if (cone.line_parameter(Vec3d(fit.start.positions[v])) <= 1) return {};
    return normalized(cone.axis, {0, 0, 0});
}

/// Sum of the area vectors of a vertex's faces that are not flat ends.
Vec3d area_about(const Fit& fit, std::size_t v) {
    Vec3d sum;
    for (const std::uint32_t f : fit.faces_of[v]) {
        if (!fit.flat[f]) sum += area_vector(fit.start.face(f), fit.positions);
    }
    return sum;
}

/// Every vertex moves along its normal but for what is held, so that one at the very end of a tip stays.
void find_directions(Fit& fit) {
    fit.direction.resize(fit.vertex_count());
    parallel_for(fit.ctx, fit.vertex_count(), kFitVolumeGrain, [&](std::size_t v) {
        if (fit.capsule[v] == CapsuleTree::kNone) return;
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

/// How far it is from p along the unit vector n to the bark of a cone, which is taken to be round about its
/// foot.
double gap_to(const RoundCone& cone, Vec3d p, Vec3d n) {
    constexpr double kLeastCosine = 0.2;
    const RoundCone::Foot foot = cone.foot(p);
    const double d = foot.distance(), r = foot.radius, along = dot(n, foot.offset);
    const double under_root = along * along + r * r - d * d;
    double way = 0;
    if (along > 0 && under_root >= 0) {
        way = std::sqrt(under_root) - along;
    } else if (along > kLeastCosine * d) {
        way = (r - d) * d / along;
    }
    return std::clamp(way, -kMostGap * r, kMostGap * r);
}

/// The segment of these vertices that a point lies on.
std::uint32_t capsule_at(const Fit& fit, std::span<const std::uint32_t> vertices, Vec3d p) {
    std::uint32_t best = CapsuleTree::kNone;
    double least = 0;
    for (const std::uint32_t v : vertices) {
        const std::uint32_t i = fit.capsule[v];
        if (i == CapsuleTree::kNone || i == best) continue;
        const double there = fit.solid.capsules().cone(i).foot(p).relative_squared();
        if (best != CapsuleTree::kNone && there >= least) continue;
        least = there;
        best = i;
    }
    return best;
}

/// The volume between a triangle of a face and the cones: exact where the gap is quadratic.
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
    if (!(size > 0) || i == CapsuleTree::kNone) return 0;
    const double of_middle = std::max(gap_to(fit.solid.capsules().cone(i), middle, area / size),
                                      -kMostSwelling * double{fit.radius[t[0]]});
    return size * (kShareOfMiddle * of_middle + (1 - kShareOfMiddle) * of_corners);
}

std::vector<double> gaps_of_vertices(const Fit& fit) {
    std::vector<double> gap(fit.vertex_count(), 0.0);
    parallel_for(fit.ctx, gap.size(), kFitVolumeGrain, [&](std::size_t v) {
        if (fit.capsule[v] == CapsuleTree::kNone) return;
        const RoundCone& cone = fit.solid.capsules().cone(fit.capsule[v]);
        gap[v] = gap_to(cone, Vec3d(fit.positions[v]), normalized(Vec3d(fit.direction[v]), {0, 0, 0}));
    });
    return gap;
}

/// What the volume gains by a vertex that moves by its radius: a third of its triangles' area does, a quarter
/// of its quads'.
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

/// Every vertex gives what it has to its faces, and these to their corners.
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

Need sum_of(std::span<const Need> needs) {
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

/// How many times needs are spread, to go about a radius far: a pass goes as far as an edge is long, and the
/// way grows with the root of their number.
int passes(const Fit& fit, std::span<const Need> needs) {
    constexpr double kPassesPerSquareRadius = 2, kMostPasses = 60, kMostVertices = 100;
    const double squares = parallel_reduce(
        fit.ctx, needs.size(), kFitVolumeGrain, 0.0,
        [&](IndexRange range) {
            double part = 0;
            for (std::size_t v = range.begin; v < range.end; ++v) {
                const double r = fit.radius[v], cube = r * r * r;
                if (needs[v].per_radius > 0) part += std::min(kMostVertices, cube / needs[v].per_radius);
            }
            return part;
        },
        std::plus<>());
    const double mean = squares / static_cast<double>(std::max<std::size_t>(1, needs.size()));
    return static_cast<int>(std::lround(std::clamp(kPassesPerSquareRadius * mean, 1.0, kMostPasses)));
}

/// Moves the vertices by what is missing about them; returns how much that is in all, and how far all
/// vertices had to move for it if they did so alike.
struct Step {
    double volume = 0, radii = 0;
};
Step step(Fit& fit) {
    std::vector<Need> needs = find_needs(fit), of_face(fit.face_count());
    const Need all = sum_of(needs);
    if (!(all.per_radius > 0)) return {};
    for (int left = passes(fit, needs); left > 0; --left) {
        fit.ctx.throw_if_cancelled();
        spread(fit, needs, of_face);
    }
    const Step done{all.volume, all.volume / all.per_radius};
    const double most = kMostOffset + 2 * std::min(std::fabs(done.radii), kMostCoarse);
    move(fit, [&](std::size_t v) {
        if (!(needs[v].per_radius > 0)) return 0.0;
        const double so_far = double{fit.offset[v]} / double{fit.radius[v]};
        const double radii = needs[v].volume / needs[v].per_radius;
        return std::clamp(so_far + radii, std::min(so_far, -most), std::max(so_far, most)) - so_far;
    });
    return done;
}

/// Fits all parts; returns how coarse the surface is: how many radii it had to grow at first.
double fit_parts(Fit& fit, double cones) {
    const Step first = step(fit);
    Step last = first;
    for (int k = 1; k < kMostSteps && std::fabs(last.volume) > kDone * cones; ++k) last = step(fit);
    return first.radii;
}

/// Moves all vertices by the same part of their radius.
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

/// Whether the surface has all parts of the cones, and few of them twice. That cross-sections had to grow by
/// a part of the radius explains a volume as much smaller, squared, by and large.
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

void report_offsets(const Fit& fit, FitVolumeReport& report) {
    for (std::size_t v = 0; v < fit.vertex_count(); ++v) {
        report.pulled_back += fit.held[v];
        if (!(fit.radius[v] > 0)) continue;
        const double radii = double{fit.offset[v]} / double{fit.radius[v]};
        report.mean_offset += radii / static_cast<double>(fit.vertex_count());
        report.greatest_offset = std::max(report.greatest_offset, std::fabs(radii));
    }
}

FitVolumeReport fit_polygons(PolygonMesh start, Buffer<Vec3>& positions, const Skeleton& skeleton,
                             const ConeUnion& solid, const CrossingSearch& search, const Context& ctx) {
    FitVolumeReport report;
    const UnionVolume cones = union_volume(solid, {}, {}, part_of(ctx, 0, 0.3f));
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
    find_capsules(fit);
    limit_radii(fit);
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
    for (int k = 0; k < kMostSteps && report.closed && !is_near(kExact); ++k) {
        close(fit, report.cones);
        pull_back(fit);
    }
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
