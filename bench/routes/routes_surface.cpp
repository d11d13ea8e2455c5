#include "routes_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/measure/capsule_tree.h"

namespace coppice::bench {
namespace {

constexpr std::size_t kGrain = 1024;
constexpr std::uint32_t kMaxFaces = 1'000'000;
constexpr std::size_t kParts = 10;  // number of classes by radius; the thickest and the thinnest are used

/// One face relative to the skeleton.
struct FacePlace {
    std::uint32_t capsule = kNoIndex;
    double radius = 1;     ///< [m] of the segment at its closest point
    double min_angle = 0;  ///< [degrees]
};

class FaceJudge {
  public:
    FaceJudge(const PolygonMesh& mesh, const CapsuleTree& capsules) : mesh_(mesh), capsules_(capsules) {}

    FacePlace place(std::uint32_t f, std::uint32_t hint) const {
        const auto face = mesh_.face(f);
        Vec3d center{};
        for (const std::uint32_t v : face) center = center + at(v);
        center = center * (1.0 / static_cast<double>(face.size()));
        FacePlace out;
        out.capsule = capsules_.nearest(center, hint).capsule;
        const RoundCone& c = capsules_.cone(out.capsule);
        out.radius = c.closest_point(center).radius;
        out.min_angle = min_angle(face);
        return out;
    }

    template <class Visit>
    void edges(std::uint32_t f, const Visit& visit) const {
        const auto face = mesh_.face(f);
        for (std::size_t i = 0; i < face.size(); ++i) {
            visit(length(at(face[(i + 1) % face.size()]) - at(face[i])));
        }
    }

  private:
    Vec3d at(std::uint32_t v) const { return Vec3d(mesh_.positions[v]); }

    double min_angle(std::span<const std::uint32_t> face) const {
        double least = std::numbers::pi;
        for (std::size_t i = 0, n = face.size(); i < n; ++i) {
            const Vec3d p = at(face[i]), a = at(face[(i + 1) % n]) - p, b = at(face[(i + n - 1) % n]) - p;
            least = std::min(least, std::atan2(length(cross(a, b)), dot(a, b)));
        }
        return least * 180 / std::numbers::pi;
    }

    const PolygonMesh& mesh_;
    const CapsuleTree& capsules_;
};

/// The sampled faces and their positions.
struct Sample {
    std::vector<std::uint32_t> faces;
    std::vector<FacePlace> places;
    double each = 1;  ///< number of faces that each sample represents
};

Sample sample_faces(const PolygonMesh& mesh, const FaceJudge& judge, const Context& ctx) {
    const std::uint32_t all = mesh.face_count(), count = std::min(all, kMaxFaces);
    Sample out;
    out.each = count == 0 ? 1 : static_cast<double>(all) / count;
    out.faces.resize(count);
    out.places.resize(count);
    parallel_for_ranges(ctx, count, kGrain, [&](IndexRange range) {
        std::uint32_t hint = kNoIndex;
        for (std::size_t i = range.begin; i < range.end; ++i) {
            out.faces[i] = static_cast<std::uint32_t>(i * std::uint64_t{all} / count);
            out.places[i] = judge.place(out.faces[i], hint);
            hint = out.places[i].capsule;
        }
    });
    return out;
}

/// Returns the figures of the given segments.
PartFigures part(std::span<const std::uint32_t> segments, const CapsuleTree& capsules, const Sample& sample,
                 const FaceJudge& judge) {
    std::vector<bool> chosen(capsules.size(), false);
    PartFigures out;
    double lengths = 0;
    for (const std::uint32_t s : segments) {
        const RoundCone& c = capsules.cone(s);
        chosen[s] = true;
        out.radius += c.radius(0.5) / static_cast<double>(segments.size());
        lengths += length(c.axis) / c.radius(0.5);
    }
    std::uint64_t faces = 0;
    std::vector<double> edges;
    for (std::size_t i = 0; i < sample.faces.size(); ++i) {
        const FacePlace& p = sample.places[i];
        if (!chosen[p.capsule]) continue;
        ++faces;
        judge.edges(sample.faces[i], [&](double l) { edges.push_back(l / p.radius); });
    }
    out.faces_per_radius = sample.each * static_cast<double>(faces) / lengths;
    out.edge = statistics(std::move(edges)).p50;
    return out;
}

}  // namespace

SurfaceFigures compute_figures(const PolygonMesh& mesh, const Skeleton& skeleton, const Context& ctx) {
    SurfaceFigures out;
    out.vertices = mesh.positions.size();
    out.report = check_surface(mesh, &skeleton, {}, ctx);
    const CapsuleTree capsules(skeleton, mesh.origin, ctx);
    const FaceJudge judge(mesh, capsules);
    const Sample sample = sample_faces(mesh, judge, ctx);
    std::vector<double> angles, edges;
    for (std::size_t i = 0; i < sample.faces.size(); ++i) {
        angles.push_back(sample.places[i].min_angle);
        judge.edges(sample.faces[i], [&](double l) { edges.push_back(l / sample.places[i].radius); });
    }
    out.min_angle = statistics(std::move(angles)).p1;
    out.edge = statistics(std::move(edges));
    std::vector<std::uint32_t> by_radius(capsules.size());
    std::iota(by_radius.begin(), by_radius.end(), 0u);
    std::stable_sort(by_radius.begin(), by_radius.end(), [&](std::uint32_t a, std::uint32_t b) {
        return capsules.cone(a).radius(0.5) < capsules.cone(b).radius(0.5);
    });
    const std::size_t tenth = std::max<std::size_t>(1, by_radius.size() / kParts);
    out.thin = part(std::span(by_radius).first(tenth), capsules, sample, judge);
    out.thick = part(std::span(by_radius).last(tenth), capsules, sample, judge);
    return out;
}

}  // namespace coppice::bench
