#include "coppice/pipeline/restore.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/base/id.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/extract/mesh/mesh_clean.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/mesh/topology.h"
#include "coppice/pipeline/fit/limit_offsets_internal.h"
#include "coppice/subdivision/catmull_clark.h"

namespace coppice {
namespace {

constexpr std::size_t kRestoreGrain = 4096;
constexpr double kFarFromAxis = 3;  // [radii] beyond it, the closest segment is unrelated to a vertex
constexpr double kFacing = 0.25;    // minimum cosine between a vertex's normal and a face of the original

/// Intersection of the line p + t n with the triangle a, b, c from behind, at less than a grazing angle.
std::optional<double> line_triangle_intersection(Vec3d p, Vec3d n, Vec3d a, Vec3d b, Vec3d c) {
    constexpr double kSlack = 1e-9;  // tolerance, so that no line passes between two triangles
    const Vec3d ab = b - a, ac = c - a, normal = cross(ab, ac);
    const double facing = dot(normal, n);
    if (!(facing > kFacing * length(normal))) return std::nullopt;
    const Vec3d turn = cross(p - a, n);
    const double u = -dot(ac, turn) / facing, v = dot(ab, turn) / facing;
    if (u < -kSlack || v < -kSlack || u + v > 1 + kSlack) return std::nullopt;
    return dot(a - p, normal) / facing;
}

/// Returns the intersection closest to p within `reach` in both directions.
std::optional<double> nearest_intersection(const SurfaceTree& surface, Vec3d p, Vec3d n, double reach) {
    Box3 way;
    extend_outward(way, p - n * reach);
    extend_outward(way, p + n * reach);
    const auto& x = surface.mesh().positions;
    std::optional<double> nearest;
    // Of two equally close ones the outer one, so that the result does not depend on the order of the search.
    const auto better = [&](double t) {
        const double d = std::fabs(t), least = nearest ? std::fabs(*nearest) : reach;
        return d < least || (d == least && (!nearest || t > *nearest));
    };
    surface.boxes().visit_overlapping(way, [&](std::uint32_t item) {
        for (const Triangle& t : surface.triangles(surface.run(item))) {
            const auto at = line_triangle_intersection(p, n, Vec3d(x[t[0]]), Vec3d(x[t[1]]), Vec3d(x[t[2]]));
            if (at && better(*at)) nearest = at;
        }
    });
    return nearest;
}

Vec3 diagonal_normal(const Quad& q, std::span<const Vec3> x) {
    return cross(x[q[2]] - x[q[0]], x[q[3]] - x[q[1]]);
}

class Restoration {
  public:
    Restoration(QuadMesh& mesh, const SurfaceTree* original, const CapsuleTree& capsules,
                const RestoreOptions& options, const Context& ctx)
        : mesh_(mesh),
          original_(original),
          capsules_(capsules),
          options_(options),
          ctx_(ctx),
          count_(mesh.positions.size()),
          to_original_(mesh.origin - original->mesh().origin),
          start_(mesh.positions),
          patches_(mesh.quads, static_cast<std::uint32_t>(count_), 0, ctx),
          cage_(patches_.cage()) {}

    /// `turned`: the original with reversed components, in case they are wrong.
    RestoreResult run(const SurfaceTree* turned) {
        find_normals();
        find_original();
        if (turned != nullptr) prefer(turned);
        RestoreReport& report = result_.report;
        report.found = found_count();
        if (report.found == 0) return std::move(result_);
        report.distance_before = distances();
        fade();
        const Buffer<float> wanted = result_.offsets;
        limit_offsets();
        for (std::size_t v = 0; v < count_; ++v) {
            report.faded += !found_[v] && result_.offsets[v] != 0 ? 1 : 0;
            report.pulled_back += wanted[v] != result_.offsets[v] ? 1 : 0;
        }
        report.offset = offsets_in_radii();
        report.distance_after = distances();
        return std::move(result_);
    }

  private:
    template <class Body>
    void for_vertices(const Body& body) const {
        parallel_for(ctx_, count_, kRestoreGrain, body);
    }

    template <class Visit>
    void visit_fan(std::size_t v, const Visit& visit) const {
        for (const std::uint32_t half : cage_.fan(static_cast<std::uint32_t>(v))) {
            visit(half, cage_.corner(next_half_edge<4>(half)), cage_.corner(previous_half_edge<4>(half)));
        }
    }

    void find_normals() {
        normal_.resize(count_);
        for_vertices([&](std::size_t v) {
            Vec3d sum;
            visit_fan(v, [&](std::uint32_t half, std::uint32_t, std::uint32_t) {
                sum += Vec3d(diagonal_normal(mesh_.quads[half >> 2], start_));
            });
            normal_[v] = Vec3(normalized(sum, {0, 0, 0}));
        });
    }

    double local_radius(Vec3d p, std::uint32_t& hint) const {
        const CapsuleTree::Nearest nearest = capsules_.nearest(p, hint);
        if (nearest.capsule == kNoIndex || nearest.rho > kFarFromAxis) return 0;
        hint = nearest.capsule;
        return capsules_.cone(nearest.capsule).closest_point(p).radius;
    }

    void find_original() {
        radius_.assign(count_, 0.0);
        found_.assign(count_, std::uint8_t{0});
        result_.offsets.assign(count_, 0.0f);
        parallel_for_ranges(ctx_, count_, kRestoreGrain, [&](IndexRange range) {
            std::uint32_t hint = kNoIndex;
            for (std::size_t v = range.begin; v < range.end; ++v) {
                const Vec3d p(start_[v]), n(normal_[v]);
                radius_[v] = local_radius(p, hint);
                if (radius_[v] == 0 || n == Vec3d()) continue;
                const auto t =
                    nearest_intersection(*original_, p + to_original_, n, options_.reach * radius_[v]);
                if (!t) continue;
                found_[v] = 1;
                result_.offsets[v] = static_cast<float>(*t);
            }
        });
    }

    std::uint64_t found_count() const {
        return static_cast<std::uint64_t>(std::count(found_.begin(), found_.end(), 1));
    }

    /// Uses the other surface if more vertices find it.
    void prefer(const SurfaceTree* other) {
        const std::uint64_t count = found_count();
        std::swap(original_, other);
        std::vector<std::uint8_t> found = std::move(found_);
        Buffer<float> offsets = std::move(result_.offsets);
        find_original();
        result_.report.turned = found_count() > count;
        if (result_.report.turned) return;
        original_ = other;
        found_ = std::move(found);
        result_.offsets = std::move(offsets);
    }

    /// Averages over the neighbours of vertices without a result: offsets spread from known ones and decrease
    /// with distance.
    void fade() {
        Buffer<float> next = result_.offsets;
        for (int pass = 0; pass < options_.fade_passes; ++pass) {
            ctx_.throw_if_cancelled();
            for_vertices([&](std::size_t v) {
                if (found_[v]) return;
                double sum = 0, n = 0;
                visit_fan(v, [&](std::uint32_t, std::uint32_t a, std::uint32_t b) {
                    sum += double{result_.offsets[a]} + double{result_.offsets[b]};
                    n += 2;
                });
                next[v] = n > 0 ? static_cast<float>(sum / n) : 0.0f;
            });
            std::swap(next, result_.offsets);
        }
    }

    /// Moves the vertices as far as no face folds or intersects another that it did not intersect before.
    void limit_offsets() {
        constexpr std::uint32_t kHalvings = 6;
        PolygonMesh start = to_polygons(mesh_);
        const auto faces_of = pipeline_internal::faces_by_vertex(start);
        const pipeline_internal::MovingSurface moving{start, faces_of, normal_};
        const auto limited = pipeline_internal::limit_offsets(moving, result_.offsets, kHalvings, ctx_);
        if (!limited.complete) {
            throw InvalidInput(
                "the surface crosses itself too often to be restored; repair its skeleton first");
        }
        result_.report.rounds = limited.rounds;
        pipeline_internal::apply_offsets(moving, result_.offsets, mesh_.positions, ctx_);
    }

    Statistics offsets_in_radii() const {
        std::vector<double> values;
        for (std::size_t v = 0; v < count_; ++v) {
            if (radius_[v] > 0) values.push_back(double{result_.offsets[v]} / radius_[v]);
        }
        return statistics(std::move(values));
    }

    Statistics distances() const {
        std::vector<double> all(count_, -1.0);
        for_vertices([&](std::size_t v) {
            if (radius_[v] > 0)
                all[v] = original_->distance(Vec3d(mesh_.positions[v]) + to_original_) / radius_[v];
        });
        std::erase_if(all, [](double d) { return d < 0; });
        return statistics(std::move(all));
    }

    QuadMesh& mesh_;
    const SurfaceTree* original_;
    const CapsuleTree& capsules_;
    const RestoreOptions& options_;
    const Context& ctx_;
    std::size_t count_;
    Vec3d to_original_;
    Buffer<Vec3> start_;
    PatchRefinement patches_;  // of 0 levels: the topology
    CageView cage_;
    Buffer<Vec3> normal_;
    std::vector<double> radius_;  // 0: no vertex
    std::vector<std::uint8_t> found_;
    RestoreResult result_;
};

/// Returns the original with every component facing outward; nullopt if all do.
std::optional<PolygonMesh> turned_outward(const PolygonMesh& original, const Context& ctx) {
    if (original.face_count() == 0) return std::nullopt;
    CleanMeshOptions options;
    options.cards = false;
    const CleanMeshResult cleaned = clean_mesh(original, options, ctx);
    if (cleaned.repairs.flipped == 0) return std::nullopt;
    return to_polygons(cleaned.mesh);
}

}  // namespace

RestoreResult restore_offsets(QuadMesh& mesh, const PolygonMesh& original, const Skeleton& skeleton,
                              const RestoreOptions& options, const Context& ctx) {
    check_fields(options, "restore");
    validate(original);
    validate(to_polygons(mesh));
    const SurfaceTree surface(original, ctx);
    const std::optional<PolygonMesh> other = turned_outward(original, ctx);
    std::optional<SurfaceTree> turned;
    if (other) turned.emplace(*other, ctx);
    const CapsuleTree capsules(skeleton, mesh.origin, ctx);
    return Restoration(mesh, &surface, capsules, options, ctx).run(turned ? &*turned : nullptr);
}

void list_fields(RestoreOptions& o, FieldList& list) {
    list.add(
        Field{"reach",
              "Maximum distance from a vertex at which the original surface is searched, in both directions.",
              Unit::radius, 0.001, 10},
        o.reach);
    list.add(Field{"fade_passes",
                   "Approximate number of rings over which offsets fade where there is no original.",
                   Unit::none, 0, 1000},
             o.fade_passes);
}

}  // namespace coppice
