#include "coppice/pipeline/smooth_crossings.h"

#include <algorithm>
#include <vector>

#include "coppice/base/compressed_rows.h"
#include "coppice/measure/intersections.h"

namespace coppice {
namespace {

constexpr std::uint32_t kMostPairs = 1u << 20;
constexpr std::uint32_t kMostRounds = 60;
constexpr std::uint32_t kRoundsPerRing = 3;

class Film {
  public:
    Film(QuadMesh& mesh, std::vector<bool> stays, const Context& ctx)
        : mesh_(mesh),
          stays_(std::move(stays)),
          ctx_(ctx),
          crossed_(mesh.positions.size(), 0),
          moved_(mesh.positions.size(), false),
          neighbors_(compress_rows<std::uint32_t>(mesh.positions.size(), [&](const auto& put) {
              for (const Quad& q : mesh.quads) {
                  for (std::uint32_t k = 0; k < 4; ++k) put(q[k], q[(k + 1) & 3]);
              }
          })) {}

    SmoothCrossingsReport run(std::vector<FacePair> pairs) {
        SmoothCrossingsReport report{.pairs_before = pairs.size(), .pairs_after = pairs.size()};
        std::vector<Vec3> best(mesh_.positions.begin(), mesh_.positions.end());
        std::vector<FacePair> fewest = pairs;
        while (!pairs.empty() && report.rounds < kMostRounds) {
            ctx_.throw_if_cancelled();
            ++report.rounds;
            smooth(region(pairs));
            pairs = crossings();
            if (pairs.size() >= report.pairs_after) continue;
            report.pairs_after = pairs.size();
            fewest = pairs;
            std::ranges::copy(mesh_.positions, best.begin());
        }
        std::ranges::copy(best, mesh_.positions.begin());
        for (const FacePair& p : fewest) report.left.insert(report.left.end(), {p.first, p.second});
        std::ranges::sort(report.left);
        report.left.erase(std::unique(report.left.begin(), report.left.end()), report.left.end());
        return report;
    }

  private:
    /// The vertices about the quads that cross, ascending: those of the quads, two rings about them, and one
    /// more for every three rounds in which they crossed.
    std::vector<std::uint32_t> region(std::span<const FacePair> pairs) {
        std::vector<std::uint32_t> rings(mesh_.positions.size(), 0);
        std::vector<std::vector<std::uint32_t>> with;  // by the number of rings still to go
        const auto reach = [&](std::uint32_t v, std::uint32_t left) {
            if (rings[v] >= left) return;
            rings[v] = left;
            if (with.size() <= left) with.resize(left + 1);
            with[left].push_back(v);
        };
        for (const FacePair& p : pairs) {
            for (const std::uint32_t f : {p.first, p.second}) {
                for (const std::uint32_t v : mesh_.quads[f]) {
                    if (rings[v] == 0) reach(v, 2 + ++crossed_[v] / kRoundsPerRing);
                }
            }
        }
        for (std::size_t left = with.size(); left-- > 2;) {
            for (std::size_t i = 0; i < with[left].size(); ++i) {
                const std::uint32_t v = with[left][i];
                if (rings[v] != left) continue;
                for (const std::uint32_t n : neighbors_[v]) reach(n, static_cast<std::uint32_t>(left) - 1);
            }
        }
        std::vector<std::uint32_t> found;
        for (std::uint32_t v = 0; v < rings.size(); ++v) {
            if (rings[v] > 0 && !stays_[v]) found.push_back(v);
        }
        return found;
    }

    void smooth(const std::vector<std::uint32_t>& vertices) {
        constexpr int kPasses = 4;
        constexpr float kWeight = 0.5f;
        for (const std::uint32_t v : vertices) moved_[v] = true;
        std::vector<Vec3> next(vertices.size());
        for (int pass = 0; pass < kPasses; ++pass) {
            for (std::size_t i = 0; i < vertices.size(); ++i) {
                Vec3 sum;
                for (const std::uint32_t n : neighbors_[vertices[i]]) sum += mesh_.positions[n];
                next[i] = lerp(mesh_.positions[vertices[i]],
                               sum / static_cast<float>(neighbors_[vertices[i]].size()), kWeight);
            }
            for (std::size_t i = 0; i < vertices.size(); ++i) mesh_.positions[vertices[i]] = next[i];
        }
    }

    std::vector<FacePair> crossings() {
        std::vector<Box3> boxes;
        const FaceView mesh(mesh_);
        for (std::uint32_t q = 0; q < mesh.size(); ++q) {
            if (std::ranges::any_of(mesh.face(q), [&](std::uint32_t v) { return moved_[v]; }))
                boxes.push_back(mesh.box(q));
        }
        return crossings_among(mesh, faces_near(mesh, boxes, ctx_), kMostPairs, ctx_).pairs;
    }

    QuadMesh& mesh_;
    const std::vector<bool> stays_;
    const Context& ctx_;
    std::vector<std::uint32_t> crossed_;  ///< per vertex: rounds in which its quads crossed
    std::vector<bool> moved_;             ///< per vertex: in any round
    const CompressedRows<std::uint32_t> neighbors_;
};

}  // namespace

SmoothCrossingsReport smooth_crossings(QuadMesh& mesh, std::span<const std::uint32_t> fixed,
                                       const Context& ctx) {
    const std::vector<FacePair> pairs = crossing_faces(SurfaceTree(to_polygons(mesh)), kMostPairs, ctx).pairs;
    if (pairs.empty()) return {};
    std::vector<bool> stays(mesh.positions.size(), false);
    for (const std::uint32_t q : fixed) {
        for (const std::uint32_t v : mesh.quads[q]) stays[v] = true;
    }
    return Film(mesh, std::move(stays), ctx).run(pairs);
}

}  // namespace coppice
