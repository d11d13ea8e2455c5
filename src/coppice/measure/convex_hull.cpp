#include "coppice/measure/convex_hull.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/base/random.h"
#include "coppice/measure/predicates_internal.h"

namespace coppice {
namespace {

constexpr std::uint32_t kPointsPerPoll = 4096;

/// A face of the hull of the points inserted so far. Points are numbered in the order of insertion.
struct Face {
    Triangle corners{};
    std::array<std::uint32_t, 3> neighbours{};  ///< across the edges that begin at these corners
    std::vector<std::uint32_t> seen_by = {};    ///< points not inserted yet, in their order
    std::uint32_t judged_by = kNoIndex;         ///< the last point for which `is_seen` was computed
    bool is_seen = false;
    bool is_removed = false;
};

/// Returns the indices of the points in an order that does not depend on their positions.
std::vector<std::uint32_t> random_order(std::size_t size) {
    const CounterRandom random(0, 0);
    std::vector<std::uint32_t> order(size);
    std::iota(order.begin(), order.end(), 0u);
    for (std::size_t i = size; i > 1; --i) std::swap(order[i - 1], order[random.bits(i) % i]);
    return order;
}

/// Returns the first four points that span a tetrahedron, the last one below the face of the others.
std::optional<std::array<std::uint32_t, 4>> first_tetrahedron(std::span<const Vec3> p) {
    const auto size = static_cast<std::uint32_t>(p.size());
    std::uint32_t b = 1;
    while (b < size && p[b] == p[0]) ++b;
    std::uint32_t c = b + 1;
    while (c < size && is_degenerate({p[0], p[b], p[c]})) ++c;
    std::uint32_t d = c + 1;
    while (d < size && orientation(p[0], p[b], p[c], p[d]) == 0) ++d;
    if (d >= size) return std::nullopt;
    if (orientation(p[0], p[b], p[c], p[d]) > 0) std::swap(b, c);
    return std::array{0u, b, c, d};
}

class Hull {
  public:
    Hull(std::span<const Vec3> points, std::array<std::uint32_t, 4> first)
        : points_(points), face_seen_(points.size(), kNoIndex), face_from_(points.size(), kNoIndex) {
        const auto [a, b, c, d] = first;
        // Faces 0 to 3, each adjacent to the other three.
        faces_ = {
            {{a, b, c}, {1, 2, 3}}, {{b, a, d}, {0, 3, 2}}, {{c, b, d}, {0, 1, 3}}, {{a, c, d}, {0, 2, 1}}};
        for (std::uint32_t q = 0; q < points_.size(); ++q)
            for (std::uint32_t f = 0; f < faces_.size(); ++f) note_if_seen(f, q);
    }

    /// Inserts a point. Points must be inserted in their order, each once.
    void add(std::uint32_t p) {
        if (face_seen_[p] == kNoIndex) return;
        find_seen_faces(p);
        add_cone(p);
        for (const std::uint32_t f : seen_) remove(f);
    }

    /// Calls visit(corners) for every face.
    template <class Visit>
    void for_each_face(const Visit& visit) const {
        for (const Face& face : faces_)
            if (!face.is_removed) visit(face.corners);
    }

  private:
    bool sees(std::uint32_t p, const Face& face) const {
        const auto [a, b, c] = face.corners;
        return orientation(points_[a], points_[b], points_[c], points_[p]) > 0;
    }

    void note_if_seen(std::uint32_t f, std::uint32_t q) {
        if (!sees(q, faces_[f])) return;
        faces_[f].seen_by.push_back(q);
        face_seen_[q] = f;
    }

    bool is_seen(std::uint32_t f, std::uint32_t p) {
        Face& face = faces_[f];
        if (face.judged_by != p) face.is_seen = sees(p, face);
        face.judged_by = p;
        return face.is_seen;
    }

    /// Collects the visible faces. They are connected, so they are found from one of them.
    void find_seen_faces(std::uint32_t p) {
        seen_.assign(1, face_seen_[p]);
        (void)is_seen(seen_.front(), p);
        for (std::size_t i = 0; i < seen_.size(); ++i) {
            for (const std::uint32_t g : faces_[seen_[i]].neighbours) {
                if (faces_[g].judged_by != p && is_seen(g, p)) seen_.push_back(g);
            }
        }
    }

    /// Connects the rim of the visible faces to the point. A point that sees a new face sees one of the two
    /// faces adjacent to its rim edge; a point that saw a removed face and is still outside sees a new one.
    void add_cone(std::uint32_t p) {
        for (const std::uint32_t f : seen_)
            for (const std::uint32_t q : faces_[f].seen_by) face_seen_[q] = kNoIndex;
        made_.clear();
        for (const std::uint32_t f : seen_) {
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t g = faces_[f].neighbours[k];
                if (!faces_[g].is_seen) add_face(p, f, k, g);
            }
        }
        for (const std::uint32_t f : made_) {
            const std::uint32_t next = face_from_[faces_[f].corners[1]];
            faces_[f].neighbours[1] = next;
            faces_[next].neighbours[2] = f;
        }
    }

    /// Adds the face over edge k of the face f, which is adjacent to g there.
    void add_face(std::uint32_t p, std::uint32_t f, std::size_t k, std::uint32_t g) {
        const std::uint32_t from = faces_[f].corners[k], to = faces_[f].corners[(k + 1) % 3];
        const std::uint32_t made = free_face();
        faces_[made] = {{from, to, p}, {g, kNoIndex, kNoIndex}};
        made_.push_back(made);
        face_from_[from] = made;
        std::ranges::replace(faces_[g].neighbours, f, made);
        candidates_.clear();
        std::ranges::set_union(faces_[f].seen_by, faces_[g].seen_by, std::back_inserter(candidates_));
        for (const std::uint32_t q : candidates_)
            if (q > p) note_if_seen(made, q);
    }

    std::uint32_t free_face() {
        if (free_.empty()) {
            faces_.emplace_back();
            return static_cast<std::uint32_t>(faces_.size()) - 1;
        }
        const std::uint32_t f = free_.back();
        free_.pop_back();
        return f;
    }

    void remove(std::uint32_t f) {
        faces_[f] = {};
        faces_[f].is_removed = true;
        free_.push_back(f);
    }

    std::span<const Vec3> points_;
    std::vector<Face> faces_;
    std::vector<std::uint32_t> free_;       // removed faces
    std::vector<std::uint32_t> face_seen_;  // per point a face that it sees; kNoIndex inside
    std::vector<std::uint32_t> face_from_;  // per point the latest new face with a rim edge that begins there
    std::vector<std::uint32_t> seen_, made_, candidates_;  // of the current point
};

/// Returns the faces with only the vertices that they use, in the order of the points.
TriMesh make_mesh(const Hull& hull, std::span<const Vec3> points, std::span<const std::uint32_t> order) {
    std::vector<std::uint32_t> vertex(points.size(), kNoIndex);
    hull.for_each_face([&](const Triangle& corners) {
        for (const std::uint32_t c : corners) vertex[order[c]] = 0;
    });
    TriMesh out;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (vertex[i] == kNoIndex) continue;
        vertex[i] = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(points[i]);
    }
    hull.for_each_face([&](const Triangle& c) {
        out.triangles.push_back({vertex[order[c[0]]], vertex[order[c[1]]], vertex[order[c[2]]]});
    });
    return out;
}

}  // namespace

TriMesh convex_hull(std::span<const Vec3> points, const Context& ctx) {
    if (points.size() < 4) return {};
    const std::vector<std::uint32_t> order = random_order(points.size());
    std::vector<Vec3> shuffled;
    shuffled.reserve(points.size());
    for (const std::uint32_t i : order) shuffled.push_back(points[i]);
    const auto first = first_tetrahedron(shuffled);
    if (!first) return {};
    Hull hull(shuffled, *first);
    for (std::uint32_t p = 0; p < shuffled.size(); ++p) {
        if (p % kPointsPerPoll == 0) ctx.throw_if_cancelled();
        hull.add(p);
    }
    return make_mesh(hull, points, order);
}

}  // namespace coppice
