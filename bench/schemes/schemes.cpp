#include "schemes.h"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "coppice/subdivision/catmull_clark.h"

namespace coppice::bench {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
constexpr double kTension = 1.0 / 16;  // of the butterfly, as in [Dyn1990]

void add_face(PolygonMesh& mesh, const std::vector<std::uint32_t>& face) {
    mesh.corners.insert(mesh.corners.end(), face.begin(), face.end());
    mesh.first.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
}

std::uint32_t add_point(PolygonMesh& mesh, Vec3d p) {
    mesh.positions.push_back(Vec3(p));
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

// A closed mesh of triangles by its directed edges.
class Triangles {
  public:
    explicit Triangles(const PolygonMesh& mesh) : mesh_(mesh) {
        for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
            const auto t = mesh.face(f);
            for (std::size_t k = 0; k < 3; ++k) {
                opposite_[{t[k], t[(k + 1) % 3]}] = t[(k + 2) % 3];
                start_[t[k]] = t[(k + 1) % 3];
            }
        }
    }

    const PolygonMesh& mesh() const { return mesh_; }
    Vec3d at(std::uint32_t v) const { return Vec3d(mesh_.positions[v]); }
    // Returns the third corner of the triangle with this edge.
    std::uint32_t opposite(std::uint32_t a, std::uint32_t b) const { return opposite_.at({a, b}); }
    // Returns the neighbours of v in order, starting at `first`.
    std::vector<std::uint32_t> ring(std::uint32_t v, std::uint32_t first) const {
        std::vector<std::uint32_t> out;
        std::uint32_t n = first;
        do {
            out.push_back(n);
            n = opposite(v, n);
        } while (n != first);
        return out;
    }
    std::vector<std::uint32_t> ring(std::uint32_t v) const { return ring(v, start_.at(v)); }

    // Divides every triangle into four, of old_point(v) and edge_point(a, b).
    template <class OldPoint, class EdgePoint>
    PolygonMesh quartered(const OldPoint& old_point, const EdgePoint& edge_point) const {
        PolygonMesh out;
        for (std::uint32_t v = 0; v < mesh_.positions.size(); ++v) add_point(out, old_point(v));
        std::map<Edge, std::uint32_t> middle;
        const auto compute_middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [place, is_new] = middle.try_emplace(std::minmax(a, b), 0);
            if (is_new) place->second = add_point(out, edge_point(a, b));
            return place->second;
        };
        for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
            const auto t = mesh_.face(f);
            const std::uint32_t ab = compute_middle(t[0], t[1]), bc = compute_middle(t[1], t[2]),
                                ca = compute_middle(t[2], t[0]);
            add_face(out, {t[0], ab, ca});
            add_face(out, {t[1], bc, ab});
            add_face(out, {t[2], ca, bc});
            add_face(out, {ab, bc, ca});
        }
        return out;
    }

  private:
    const PolygonMesh& mesh_;
    std::map<Edge, std::uint32_t> opposite_;
    std::map<std::uint32_t, std::uint32_t> start_;
};

PolygonMesh loop_step(const Triangles& t) {
    const auto old_point = [&](std::uint32_t v) {
        const std::vector<std::uint32_t> ring = t.ring(v);
        const auto n = static_cast<double>(ring.size());
        const double c = 0.375 + 0.25 * std::cos(2 * std::numbers::pi / n), beta = (0.625 - c * c) / n;
        Vec3d p = (1 - n * beta) * t.at(v);
        for (const std::uint32_t u : ring) p += beta * t.at(u);
        return p;
    };
    const auto edge_point = [&](std::uint32_t a, std::uint32_t b) {
        return 0.375 * (t.at(a) + t.at(b)) + 0.125 * (t.at(t.opposite(a, b)) + t.at(t.opposite(b, a)));
    };
    return t.quartered(old_point, edge_point);
}

// Eight points: the edge, the two opposite it, and the four beyond their sides.
Vec3d butterfly_point(const Triangles& t, std::uint32_t a, std::uint32_t b) {
    const std::uint32_t c = t.opposite(a, b), d = t.opposite(b, a);
    const Vec3d wings =
        t.at(t.opposite(c, b)) + t.at(t.opposite(a, c)) + t.at(t.opposite(d, a)) + t.at(t.opposite(b, d));
    return 0.5 * (t.at(a) + t.at(b)) + 2 * kTension * (t.at(c) + t.at(d)) - kTension * wings;
}

// Zorin's stencil around an irregular vertex v, for its edge to u.
Vec3d irregular_point(const Triangles& t, std::uint32_t v, std::uint32_t u) {
    const std::vector<std::uint32_t> ring = t.ring(v, u);
    const std::size_t n = ring.size();
    Vec3d p = 0.75 * t.at(v);
    for (std::size_t k = 0; k < n; ++k) {
        double weight = 0;
        if (n == 3) {
            weight = k == 0 ? 5.0 / 12 : -1.0 / 12;
        } else if (n == 4) {
            weight = k == 0 ? 3.0 / 8 : k == 2 ? -1.0 / 8 : 0;
        } else {
            const double a = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
            weight = (0.25 + std::cos(a) + 0.5 * std::cos(2 * a)) / static_cast<double>(n);
        }
        p += weight * t.at(ring[k]);
    }
    return p;
}

PolygonMesh butterfly_step(const Triangles& t, bool modified) {
    const auto edge_point = [&](std::uint32_t a, std::uint32_t b) {
        const bool odd_a = modified && t.ring(a).size() != 6, odd_b = modified && t.ring(b).size() != 6;
        if (odd_a && odd_b) return 0.5 * (irregular_point(t, a, b) + irregular_point(t, b, a));
        if (odd_a) return irregular_point(t, a, b);
        if (odd_b) return irregular_point(t, b, a);
        return butterfly_point(t, a, b);
    };
    return t.quartered([&](std::uint32_t v) { return t.at(v); }, edge_point);
}

PolygonMesh doo_sabin_step(const PolygonMesh& mesh) {
    PolygonMesh out;
    std::map<Edge, std::uint32_t> corner;     // by the edge that leaves it within its face: the new point
    std::map<Edge, std::uint32_t> following;  // by the same edge: the previous vertex of that face
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const auto face = mesh.face(f);
        const std::size_t n = face.size();
        std::vector<std::uint32_t> inner;
        for (std::size_t i = 0; i < n; ++i) {
            Vec3d p;
            for (std::size_t j = 0; j < n; ++j) {
                const double turn = 2 * std::numbers::pi * (static_cast<double>(i) - static_cast<double>(j)) /
                                    static_cast<double>(n);
                const double weight = i == j ? 0.25 + 1.25 / static_cast<double>(n)
                                             : (3 + 2 * std::cos(turn)) / (4 * static_cast<double>(n));
                p += weight * Vec3d(mesh.positions[face[j]]);
            }
            inner.push_back(add_point(out, p));
            corner[{face[i], face[(i + 1) % n]}] = inner.back();
            following[{face[i], face[(i + 1) % n]}] = face[(i + n - 1) % n];
        }
        add_face(out, inner);
    }
    // The point of b in the face of the edge from a to b is the point of the next edge.
    std::map<Edge, std::uint32_t> end;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const auto face = mesh.face(f);
        const std::size_t n = face.size();
        for (std::size_t i = 0; i < n; ++i)
            end[{face[i], face[(i + 1) % n]}] = corner.at({face[(i + 1) % n], face[(i + 2) % n]});
    }
    std::vector<bool> is_done(mesh.positions.size());
    for (const auto& [edge, point] : corner) {
        const auto [a, b] = edge;
        if (a < b) add_face(out, {end.at({b, a}), corner.at({b, a}), end.at(edge), point});
        if (is_done[a]) continue;
        is_done[a] = true;
        std::vector<std::uint32_t> around;
        std::uint32_t to = b;
        do {
            around.push_back(corner.at({a, to}));
            to = following.at({a, to});
        } while (to != b);
        add_face(out, around);
    }
    return out;
}

PolygonMesh catmull_clark_step(const PolygonMesh& mesh) {
    std::vector<Quad> quads(mesh.face_count());
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const auto face = mesh.face(f);
        quads[f] = {face[0], face[1], face[2], face[3]};
    }
    const PatchRefinement patches(quads, static_cast<std::uint32_t>(mesh.positions.size()), 1);
    return to_polygons(QuadMesh{patches.refine(mesh.positions), patches.quads(), {}});
}

}  // namespace

std::string_view name_of(Scheme scheme) {
    switch (scheme) {
        case Scheme::loop:
            return "Loop";
        case Scheme::butterfly:
            return "Butterfly";
        case Scheme::modified_butterfly:
            return "Butterfly, modified";
        case Scheme::doo_sabin:
            return "Doo-Sabin";
        case Scheme::catmull_clark:
            break;
    }
    return "Catmull-Clark";
}

bool takes_triangles(Scheme scheme) { return scheme != Scheme::doo_sabin && scheme != Scheme::catmull_clark; }

PolygonMesh triangulated(const PolygonMesh& mesh) {
    PolygonMesh out;
    out.positions = mesh.positions;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const auto face = mesh.face(f);
        for (std::size_t k = 1; k + 1 < face.size(); ++k) add_face(out, {face[0], face[k], face[k + 1]});
    }
    return out;
}

PolygonMesh subdivided(const PolygonMesh& mesh, Scheme scheme) {
    switch (scheme) {
        case Scheme::loop:
            return loop_step(Triangles(mesh));
        case Scheme::butterfly:
        case Scheme::modified_butterfly:
            return butterfly_step(Triangles(mesh), scheme == Scheme::modified_butterfly);
        case Scheme::doo_sabin:
            return doo_sabin_step(mesh);
        case Scheme::catmull_clark:
            break;
    }
    return catmull_clark_step(mesh);
}

}  // namespace coppice::bench
