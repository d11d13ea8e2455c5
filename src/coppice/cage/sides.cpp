#include <algorithm>
#include <utility>

#include "coppice/base/sort.h"
#include "coppice/cage/sides_internal.h"

namespace coppice::cage_internal {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge find_edge(const Quad& q, std::size_t k) { return std::minmax(q[k], q[(k + 1) % 4]); }

/// A vertex midway between others, with the mean of their distances from their anchors.
class Middle {
  public:
    explicit Middle(ControlMesh& mesh) : mesh_(mesh) {}

    template <class Vertices>
    std::uint32_t add(const Vertices& around) const {
        Vec3 out, anchor;
        float radius = 0;
        const float share = 1 / static_cast<float>(around.size());
        for (const std::uint32_t v : around) {
            const Vec3 d = mesh_.cage.positions[v] - mesh_.anchors[v];
            out += d;
            radius += length(d) * share;
            anchor += mesh_.anchors[v] * share;
        }
        mesh_.anchors.push_back(anchor);
        mesh_.cage.positions.push_back(anchor + normalized(out) * radius);
        return static_cast<std::uint32_t>(mesh_.anchors.size() - 1);
    }

  private:
    ControlMesh& mesh_;
};

}  // namespace

void double_sides(ControlMesh& mesh, std::vector<QuadKind>& kind) {
    std::vector<Edge> edges;
    for (std::size_t f = 0; f < kind.size(); ++f) {
        for (std::size_t k = 0; k < 4; ++k) {
            if (kind[f] == QuadKind::face || k % 2 == 0) edges.push_back(find_edge(mesh.cage.quads[f], k));
        }
    }
    sort_unique(edges);
    const Middle middle(mesh);
    const auto first = static_cast<std::uint32_t>(mesh.anchors.size());
    for (const Edge& e : edges) middle.add(std::array{e.first, e.second});
    const auto halfway = [&](const Quad& q, std::size_t k) {
        const auto found = std::lower_bound(edges.begin(), edges.end(), find_edge(q, k));
        return first + static_cast<std::uint32_t>(found - edges.begin());
    };

    Buffer<Quad> quads;
    std::vector<QuadKind> kinds;
    std::vector<std::uint32_t> region;
    std::vector<TubeFace> part;
    std::vector<std::uint32_t> first_of{0};  // new quads, by old quad
    for (std::size_t f = 0; f < kind.size(); ++f) {
        const Quad q = mesh.cage.quads[f];
        if (kind[f] == QuadKind::tube) {
            const std::uint32_t a = halfway(q, 0), b = halfway(q, 2);
            quads.push_back({q[0], a, b, q[3]});
            quads.push_back({a, q[1], q[2], b});
        } else {
            const std::uint32_t center = middle.add(q);
            for (std::size_t k = 0; k < 4; ++k)
                quads.push_back({q[k], halfway(q, k), center, halfway(q, (k + 3) % 4)});
        }
        kinds.resize(quads.size(), kind[f]);
        region.resize(quads.size(), mesh.region[f]);
        part.resize(quads.size(), mesh.part[f]);
        first_of.push_back(static_cast<std::uint32_t>(quads.size()));
    }
    for (ClipPlane& clip : mesh.clip) {
        const std::uint32_t end = first_of[clip.first_quad + clip.quad_count];
        clip.first_quad = first_of[clip.first_quad];
        clip.quad_count = end - clip.first_quad;
    }
    mesh.cage.quads = std::move(quads);
    mesh.region = std::move(region);
    mesh.part = std::move(part);
    kind = std::move(kinds);
}

}  // namespace coppice::cage_internal
