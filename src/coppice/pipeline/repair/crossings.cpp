// Most quads are proved not to intersect; those without a proof are searched. A pair of quads is proved by
// one of:
//
//  * The star of a node. Seen from the node, rows around it face away everywhere, as many from each tube as
//  possible, closed by the cap of the tube or by a cone over the ring at which they end. That is a closed
//  surface, and central projection maps it to the sphere of directions without folds; if it also turns once
//  around every vertex, the map is locally one to one, and a covering of the sphere is then one to one. So
//  none of these quads intersect. Every quad is tested with both its diagonals: its corners turn by less than
//  half a turn each, so that at most four of them turn once around a vertex, and only the vertices of branch
//  nodes, where more quads meet, have to be checked. A star around a point within a tube is the same with two
//  rings.
//  * The opening of a ring. If all later rows of the tube are within the directions that the ring encloses,
//  all other quads of the star are outside, and so are the later rows of other such tubes.
//  * A plane between two rows that touches neither, across the axis of a tube or along one of a few other
//  directions; or between two tubes with disjoint boxes or other disjoint bounds.
//
// Every tube is compared with itself and with all tubes of overlapping boxes. Rows of pairs without a proof
// are searched together by crossing_faces(). Rounding: everything is computed in double precision, in which
// differences of coordinates are exact up to the last bit, and a test succeeds only by a margin.

#include "coppice/pipeline/repair/crossings_internal.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "coppice/base/number_set.h"
#include "coppice/base/parallel.h"
#include "coppice/pipeline/repair/tube_proofs_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::uint32_t kUncertain = 1u << 16;  // more turns than possible
constexpr std::size_t kTubeGrain = 64;
constexpr std::size_t kGroupGrain = 16;
// Bound of the rounding error of a scalar product in double precision, of points and directions at most 1
// long.
constexpr double kRounding = 1e-14;
// Bound of the relative rounding error of distances.
constexpr double kDistanceRounding = 1e-9;

// Proven properties of a tube.
struct Proof {
    std::array<View, 2> view;  // from its two nodes
    bool is_star = false;      // whether its own star covers it
    double radius = 0;         // [m] maximum distance from its axis
    Bounds bounds;             // bounds of its points
};

Margins margins(const Directions& d, double size) {
    Margins m;
    for (std::size_t i = 0; i < m.size(); ++i)
        m[i] = kRounding * size * (std::fabs(d.x[i]) + std::fabs(d.y[i]) + std::fabs(d.z[i]));
    return m;
}

// The maximum absolute coordinate, and the maximum distance of the corners of a box from c.
double largest(const Bounds& b) {
    double most = 0;
    for (int i = 0; i < 3; ++i) most = std::max({most, std::fabs(b.low[i]), std::fabs(b.high[i])});
    return most;
}
double farthest(const Bounds& b, Vec3d c) {
    double sum = 0;
    for (int i = 0; i < 3; ++i)
        sum += std::max({std::fabs(b.low[i] - c[i]), std::fabs(b.high[i] - c[i]), b.high[i] - b.low[i]});
    return sum;
}

class Search {
  public:
    Search(const QuadMesh& mesh, const TubeRows& tube_rows, std::span<const TubeFaces> faces,
           const Context& ctx)
        : mesh_(mesh),
          tube_rows_(tube_rows),
          tubes_(tube_rows.tubes()),
          ctx_(ctx),
          faces_(faces),
          proof_(tubes_.size()),
          turns_(tube_rows.cage().cage.positions.size(), 0) {}

    // Returns the quads that may intersect each other, ascending; no other quads do.
    std::vector<std::uint32_t> suspects() {
        look_at_tubes();
        look_at_nodes();
        return compare_tubes();
    }

    // Per tube.
    std::vector<Box3> boxes() const {
        std::vector<Box3> out(tubes_.size());
        for (std::uint32_t t = 0; t < out.size(); ++t) {
            if (exists(t)) out[t] = {Vec3(proof_[t].bounds.low), Vec3(proof_[t].bounds.high)};
        }
        return out;
    }

  private:
    struct Workspace {
        TubePoints a, b;
        std::vector<Reach> of_a, of_b;
        std::vector<std::uint32_t> suspects;
    };
    Workspace workspace() const { return {{mesh_, tube_rows_}, {mesh_, tube_rows_}, {}, {}, {}}; }

    Vec3d position(NodeId n) const { return Vec3d(tubes_.position(n)); }
    bool exists(std::uint32_t t) const { return faces_[t].side.count + faces_[t].cap[1].count > 0; }
    // Returns the node at an end of a tube; none for a ball.
    NodeId node(NodeId tube, int end) const { return tube_rows_.node(tube, end); }

    void look_at_tubes() {
        parallel_for_ranges(ctx_, tubes_.size(), kTubeGrain, [&](IndexRange range) {
            TubePoints points(mesh_, tube_rows_);
            for (auto t = static_cast<std::uint32_t>(range.begin); t < range.end; ++t) {
                if (!exists(t)) continue;
                points.load(faces_[t]);
                look_at_tube(points, NodeId(t));
            }
        });
    }

    void look_at_tube(const TubePoints& points, NodeId t) {
        Proof& proof = proof_[t.index()];
        const auto [from, to] = ends(t);
        const Vec3d axis = find_axis(t);
        proof.bounds = points.bounds(from, axis, distance(from, to));
        proof.radius = std::sqrt(proof.bounds.distance_squared);
        bool is_alone = true;
        for (int end = 0; end < 2 && !tubes_.is_root(t); ++end) {
            if (tube_rows_.tube_count(node(t, end)) < 2) continue;
            is_alone = false;
            const Vec3d c = position(node(t, end));
            const double size = farthest(proof.bounds, c);
            proof.view[end] = points.view(end, c, end == 0 ? axis : -axis, size);
            if (!tube_rows_.is_fork(node(t, end))) continue;
            count_turns(points, t, end, size);
            if (points.has_fork(end) && !points.is_clear_beyond(end, c, size)) proof.view[end] = {};
        }
        if (!is_alone) return;
        const Vec3d c = 0.5 * (from + to);
        proof.is_star = points.is_star(c, farthest(proof.bounds, c));
    }

    // The star of a node requires a view of every tube there.
    void look_at_nodes() {
        parallel_for(ctx_, tubes_.size(), 4 * kTubeGrain, [&](std::size_t i) {
            const NodeId n(static_cast<std::uint32_t>(i));
            if (tube_rows_.tube_count(n) < 2) return;
            bool holds = true;
            tube_rows_.for_each_tube_at(n, [&](NodeId t) { holds &= view_at(t, n).clear > 0; });
            if (holds && tube_rows_.is_fork(n)) holds = turns_once(n);
            if (!holds) tube_rows_.for_each_tube_at(n, [&](NodeId t) { view_at(t, n) = {}; });
        });
    }
    View& view_at(NodeId tube, NodeId n) { return proof_[tube.index()].view[tube_rows_.end_at(tube, n)]; }

    // Counts the turns around the vertices of a branch node that the quads of one tube make.
    void count_turns(const TubePoints& points, NodeId t, int end, double size) {
        const CageRun& run = faces_[t.index()].side;
        const Vec3d c = position(node(t, end));
        const auto count = [&](std::size_t quad, std::size_t corner, int turns) {
            const std::uint32_t v = tube_rows_.cage().cage.quads[quad][corner];
            const std::uint32_t add = turns < 0 ? kUncertain : static_cast<std::uint32_t>(turns);
            if (add != 0) std::atomic_ref(turns_[v]).fetch_add(add, std::memory_order_relaxed);
        };
        points.visit_turns(end, c, size,
                           [&](std::size_t k, int turns) { count(run.first + k, end == 0 ? 0 : 3, turns); });
        points.visit_fork_turns(end, c, size, count);
    }

    // Returns whether the quads at each vertex of a branch node turn around it once. The cage's vertices come
    // first in the mesh, and each belongs to one node.
    bool turns_once(NodeId n) const {
        bool once = true;
        tube_rows_.for_each_tube_at(n, [&](NodeId t) {
            const CageRun& run = faces_[t.index()].side;
            for (std::uint32_t f = run.first; f < run.first + run.count; ++f)
                once &= turns_[tube_rows_.cage().cage.quads[f][tube_rows_.end_at(t, n) == 1 ? 3 : 0]] == 1;
        });
        const NodeId owner = tube_rows_.fork_tube(n);
        const CageRun& between = faces_[owner.index()].fork[owner == n ? 1 : 0];
        for (std::uint32_t f = between.first; f < between.first + between.count; ++f) {
            for (const std::uint32_t v : tube_rows_.cage().cage.quads[f]) once &= turns_[v] == 1;
        }
        return once;
    }

    // Compares every tube with itself, and every two tubes with overlapping boxes.
    std::vector<std::uint32_t> compare_tubes() const {
        std::vector<std::uint32_t> item;
        std::vector<Box3> boxes;
        for (std::uint32_t t = 0; t < tubes_.size(); ++t) {
            if (!exists(t)) continue;
            item.push_back(t);
            boxes.push_back({Vec3(proof_[t].bounds.low), Vec3(proof_[t].bounds.high)});
        }
        const BoxTree tree(boxes, ctx_);
        const std::size_t groups = tree.group_count();
        std::vector<std::vector<std::uint32_t>> found((groups + kGroupGrain - 1) / kGroupGrain);
        parallel_for_ranges(ctx_, groups, kGroupGrain, [&](IndexRange range) {
            Workspace work = workspace();
            const std::size_t last = std::min(range.end * BoxTree::kWidth, boxes.size());
            for (std::size_t p = range.begin * BoxTree::kWidth; p < last; ++p)
                compare_slices(NodeId(item[tree.item(static_cast<std::uint32_t>(p))]), work);
            for (std::size_t g = range.begin; g < range.end; ++g) {
                tree.overlaps(static_cast<std::uint32_t>(g), [&](std::uint32_t p, std::uint32_t q) {
                    compare(NodeId(item[tree.item(p)]), NodeId(item[tree.item(q)]), work);
                });
            }
            found[range.begin / kGroupGrain] = std::move(work.suspects);
        });
        NumberSet suspects(mesh_.quads.size());
        for (const auto& f : found) {
            for (const std::uint32_t q : f) suspects.add(q);
        }
        return suspects.ascending();
    }

    // Returns whether the star at an end of a tube covers a row.
    bool covers(NodeId t, int end, std::uint32_t row) const {
        return (end == 0 ? row : tube_rows_.per_tube() - 1 - row) < proof_[t.index()].view[end].clear;
    }

    // Returns whether the star at an end of a tube proves that two of its rows do not intersect.
    bool covers(NodeId t, int end, std::uint32_t i, std::uint32_t j) const {
        const bool first = covers(t, end, i), second = covers(t, end, j);
        return (first && second) || (first != second && proof_[t.index()].view[end].is_apart);
    }

    // Returns the rows first .. last that a star around a point on the axis covers, between those covered by
    // the nodes.
    std::array<std::uint32_t, 2> own_star(NodeId t, const TubePoints& points) const {
        const Proof& proof = proof_[t.index()];
        const std::uint32_t n = tube_rows_.per_tube();
        if (n < 2 || !points.has_sides()) return {0, 0};
        const std::uint32_t row =
            std::clamp((proof.view[0].clear + n - std::min(n, proof.view[1].clear)) / 2, 1u, n - 1);
        const Vec3d c = points.ring_center(row);
        auto [first, last] = points.clear_about(row, c, farthest(proof.bounds, c));
        // The quads beyond them belong to the outermost rows.
        if (points.is_closed(0) || points.has_fork(0)) first = std::max(first, 1u);
        if (points.is_closed(1) || points.has_fork(1)) last = std::min(last, n - 1);
        return {first, last};
    }

    // Compares the rows of one tube with each other.
    void compare_slices(NodeId t, Workspace& work) const {
        const Proof& proof = proof_[t.index()];
        const std::uint32_t n = tube_rows_.per_tube();
        const View &begin = proof.view[0], &end = proof.view[1];
        if (proof.is_star || begin.clear == n || end.clear == n) return;
        if (begin.clear + end.clear >= n && (begin.is_apart || end.is_apart)) return;
        Directions d;
        if (!tubes_.is_root(t)) d.set(0, position(t) - position(tubes_.parent(t)));
        work.a.load(faces_[t.index()]);
        work.a.reach(d, work.of_a);
        const auto margin = margins(d, largest(proof.bounds));
        const auto [first, last] = own_star(t, work.a);
        for (std::uint32_t i = 0; i < n; ++i) {
            for (std::uint32_t j = i; j < n; ++j) {
                if (covers(t, 0, i, j) || covers(t, 1, i, j) || (first <= i && j < last)) continue;
                if (is_apart(work.of_a[i], work.of_a[j], margin)) continue;
                work.a.collect(i, d, work.of_a[j], margin, work.suspects);
                work.a.collect(j, d, work.of_a[i], margin, work.suspects);
            }
        }
    }

    // Returns the ends at which two tubes meet, or -1.
    std::array<int, 2> shared_ends(NodeId a, NodeId b) const {
        if (tubes_.is_root(a) || tubes_.is_root(b)) return {-1, -1};
        for (const int end_a : {0, 1}) {
            for (const int end_b : {0, 1}) {
                if (node(a, end_a) == node(b, end_b)) return {end_a, end_b};
            }
        }
        return {-1, -1};
    }

    void compare(NodeId a, NodeId b, Workspace& work) const {
        const Proof &of_a = proof_[a.index()], &of_b = proof_[b.index()];
        const std::array<int, 2> end = shared_ends(a, b);
        const std::uint32_t n = tube_rows_.per_tube();
        const bool apart_a = end[0] >= 0 && of_a.view[end[0]].is_apart;
        const bool apart_b = end[0] >= 0 && of_b.view[end[1]].is_apart;
        if ((apart_a || (end[0] >= 0 && stays_behind(a, end[0], b, end[1]))) &&
            (apart_b || (end[1] >= 0 && stays_behind(b, end[1], a, end[0]))))
            return;
        const double size = std::max(largest(of_a.bounds), largest(of_b.bounds));
        const Directions d = directions_between(a, b, end);
        if (end[0] < 0 && axes_are_apart(a, b, d, size)) return;
        const auto margin = margins(d, size);
        work.a.load(faces_[a.index()]);
        work.b.load(faces_[b.index()]);
        work.a.reach(d, work.of_a);
        work.b.reach(d, work.of_b);
        for (std::uint32_t i = 0; i < n; ++i) {
            for (std::uint32_t j = 0; j < n; ++j) {
                if (end[0] >= 0 && (apart_a || covers(a, end[0], i)) && (apart_b || covers(b, end[1], j)))
                    continue;
                if (is_apart(work.of_a[i], work.of_b[j], margin)) continue;
                work.a.collect(i, d, work.of_b[j], margin, work.suspects);
                work.b.collect(j, d, work.of_a[i], margin, work.suspects);
            }
        }
    }

    // Returns whether the part of tube a that the star at a node does not cover is separated from all of b by
    // a plane across the axis of a. All of b is around its axis.
    bool stays_behind(NodeId a, int end_a, NodeId b, int end_b) const {
        const Proof &of_a = proof_[a.index()], &of_b = proof_[b.index()];
        const Vec3d away = position(node(a, 1 - end_a)) - position(node(a, end_a));
        const Vec3d way = position(node(b, 1 - end_b)) - position(node(b, end_b));
        const double size = of_a.radius + of_b.radius + length(away) + length(way);
        const double most = std::max(0.0, dot(way, normalized(away))) + of_b.radius;
        return of_a.view[end_a].behind > most + kDistanceRounding * size;
    }

    // Returns whether, along one of the directions, the distance of the axes of two tubes exceeds the sum of
    // their radii.
    bool axes_are_apart(NodeId a, NodeId b, const Directions& d, double size) const {
        const auto [a0, a1] = ends(a);
        const auto [b0, b1] = ends(b);
        const double reach = proof_[a.index()].radius + proof_[b.index()].radius + kDistanceRounding * size;
        for (std::size_t i = 0; i < Directions::kCount; ++i) {
            const Vec3d w{d.x[i], d.y[i], d.z[i]};
            const double a_low = std::min(dot(w, a0), dot(w, a1)), a_high = std::max(dot(w, a0), dot(w, a1)),
                         b_low = std::min(dot(w, b0), dot(w, b1)), b_high = std::max(dot(w, b0), dot(w, b1));
            const double gap = std::max(a_low - b_high, b_low - a_high);
            if (gap > 0 && gap * gap > reach * reach * length_squared(w)) return true;
        }
        return false;
    }

    // Returns the positions of the nodes of a tube; twice the same for a ball.
    std::array<Vec3d, 2> ends(NodeId t) const {
        return {position(tubes_.is_root(t) ? t : tubes_.parent(t)), position(t)};
    }
    Vec3d find_axis(NodeId t) const {
        return tubes_.is_root(t) ? Vec3d{} : normalized(position(t) - position(tubes_.parent(t)));
    }
    Vec3d center(NodeId t) const {
        const auto [from, to] = ends(t);
        return 0.5 * (from + to);
    }

    // Returns directions along which two tubes may be separated.
    Directions directions_between(NodeId a, NodeId b, std::array<int, 2> end) const {
        const Vec3d da = (end[0] == 1 ? -1.0 : 1.0) * find_axis(a),
                    db = (end[1] == 1 ? -1.0 : 1.0) * find_axis(b);
        const Vec3d way = normalized(center(b) - center(a));
        Directions d;
        d.set(0, da);
        d.set(1, db);
        d.set(2, way);
        d.set(3, cross(da, db));
        d.set(4, da - db);
        d.set(5, da + db);
        d.set(6, (end[0] >= 0 ? db : way) - da * dot(end[0] >= 0 ? db : way, da));
        d.set(7, (end[0] >= 0 ? da : way) - db * dot(end[0] >= 0 ? da : way, db));
        return d;
    }

    const QuadMesh& mesh_;
    const TubeRows& tube_rows_;
    const Skeleton& tubes_;
    const Context& ctx_;
    std::span<const TubeFaces> faces_;
    std::vector<Proof> proof_;
    std::vector<std::uint32_t> turns_;  // per vertex of the cage
};

}  // namespace

std::vector<std::uint32_t> unproved_quads(const QuadMesh& mesh, const TubeRows& tube_rows,
                                          const Context& ctx) {
    const auto faces = faces_of_tubes(tube_rows);
    return Search(mesh, tube_rows, faces, ctx).suspects();
}

TubeCrossings find_tube_crossings(const QuadMesh& mesh, const TubeRows& tube_rows, const Context& ctx) {
    TubeQuads tubes{mesh, tube_rows, faces_of_tubes(tube_rows), {}};
    Search search(mesh, tube_rows, tubes.faces, ctx);
    std::vector<FacePair> pairs = crossings_among(mesh, search.suspects(), kMaxPairs, ctx).pairs;
    tubes.boxes = search.boxes();
    return {std::move(pairs), std::move(tubes)};
}

}  // namespace coppice::pipeline_internal
