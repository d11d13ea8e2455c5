// Most quads are proved not to cross; what no proof covers is searched. A pair of quads is covered by one of:
//
//  * The star of a node. Seen from it, slices around it face away everywhere, as many from each tube as will
//    do, closed by what closes the tube or by a cone over the ring where they end. That is a closed surface,
//    and central projection takes it to the sphere of directions without folds; where it also turns once
//    about every vertex it is locally one to one, and what covers a sphere so covers it once. So none of
//    these quads meet. Every quad passes with both its diagonals: its corners turn by less than half a turn
//    each, so that at most four of them turn once about a vertex, and only the vertices of branch nodes,
//    where more meet, have to be looked at. A star about a point within a tube is the same with two rings.
//  * The opening of a ring. If all later slices of the tube lie within the directions that the ring encloses,
//    all other quads of the star are outside, and so are the later slices of other such tubes.
//  * A plane between two slices that touches neither, across the axis of a tube or along a handful of other
//    directions; or between two tubes, whose boxes are apart or whose other bounds are.
//
// Every tube is compared with itself and with all whose boxes it overlaps. Slices of pairs that are not
// covered are searched, together, by crossing_faces(). Rounding: all is computed in double precision, in
// which differences of coordinates are exact up to the last bit, and passes only by a margin.

#include "coppice/pipeline/knots/crossings_internal.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "coppice/base/number_set.h"
#include "coppice/base/parallel.h"
#include "coppice/pipeline/knots/tube_proofs_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::uint32_t kUncertain = 1u << 16;  // more turns than there are
constexpr std::size_t kTubeGrain = 64;
constexpr std::size_t kGroupGrain = 16;
// Above the rounding of a scalar product in double precision, of points and directions at most 1 long.
constexpr double kRounding = 1e-14;
// Above that of distances, over the size of what they are measured on.
constexpr double kBeside = 1e-9;

// What is known of a tube.
struct Proof {
    std::array<View, 2> view;  // from its two nodes
    bool is_star = false;      // whether a star of its own covers it
    double radius = 0;         // [m] how far it goes from its axis
    Bounds bounds;             // where it lies
};

Margins margins(const Directions& d, double size) {
    Margins m;
    for (std::size_t i = 0; i < m.size(); ++i)
        m[i] = kRounding * size * (std::fabs(d.x[i]) + std::fabs(d.y[i]) + std::fabs(d.z[i]));
    return m;
}

// The greatest coordinate by its amount, and how far the corners of a box may be from c.
double greatest(const Bounds& b) {
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
    Search(const QuadMesh& mesh, const Slices& slices, std::span<const TubeFaces> faces, const Context& ctx)
        : mesh_(mesh),
          slices_(slices),
          tubes_(slices.tubes()),
          ctx_(ctx),
          faces_(faces),
          proof_(tubes_.size()),
          turns_(slices.cage().cage.positions.size(), 0) {}

    // Quads of which some may cross each other, ascending; no others do.
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
    Workspace workspace() const { return {{mesh_, slices_}, {mesh_, slices_}, {}, {}, {}}; }

    Vec3d position(NodeId n) const { return Vec3d(tubes_.position(n)); }
    bool exists(std::uint32_t t) const { return faces_[t].side.count + faces_[t].cap[1].count > 0; }
    // The node at an end of a tube; none for a ball.
    NodeId node(NodeId tube, int end) const { return slices_.node(tube, end); }

    void look_at_tubes() {
        parallel_for_ranges(ctx_, tubes_.size(), kTubeGrain, [&](IndexRange range) {
            TubePoints points(mesh_, slices_);
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
        const Vec3d axis = axis_of(t);
        proof.bounds = points.bounds(from, axis, distance(from, to));
        proof.radius = std::sqrt(proof.bounds.distance_squared);
        bool is_alone = true;
        for (int end = 0; end < 2 && !tubes_.is_root(t); ++end) {
            if (slices_.tube_count(node(t, end)) < 2) continue;
            is_alone = false;
            const Vec3d c = position(node(t, end));
            const double size = farthest(proof.bounds, c);
            proof.view[end] = points.view(end, c, end == 0 ? axis : -axis, size);
            if (!slices_.is_fork(node(t, end))) continue;
            count_turns(points, t, end, size);
            if (points.has_fork(end) && !points.is_clear_beyond(end, c, size)) proof.view[end] = {};
        }
        if (!is_alone) return;
        const Vec3d c = 0.5 * (from + to);
        proof.is_star = points.is_star(c, farthest(proof.bounds, c));
    }

    // The star of a node needs something of every tube there.
    void look_at_nodes() {
        parallel_for(ctx_, tubes_.size(), 4 * kTubeGrain, [&](std::size_t i) {
            const NodeId n(static_cast<std::uint32_t>(i));
            if (slices_.tube_count(n) < 2) return;
            bool holds = true;
            slices_.for_each_tube_at(n, [&](NodeId t) { holds &= view_at(t, n).clear > 0; });
            if (holds && slices_.is_fork(n)) holds = turns_once(n);
            if (!holds) slices_.for_each_tube_at(n, [&](NodeId t) { view_at(t, n) = {}; });
        });
    }
    View& view_at(NodeId tube, NodeId n) { return proof_[tube.index()].view[slices_.end_at(tube, n)]; }

    // Counts the turns about the vertices of a branch node that the quads of one tube make.
    void count_turns(const TubePoints& points, NodeId t, int end, double size) {
        const CageRun& run = faces_[t.index()].side;
        const Vec3d c = position(node(t, end));
        const auto count = [&](std::size_t quad, std::size_t corner, int turns) {
            const std::uint32_t v = slices_.cage().cage.quads[quad][corner];
            const std::uint32_t add = turns < 0 ? kUncertain : static_cast<std::uint32_t>(turns);
            if (add != 0) std::atomic_ref(turns_[v]).fetch_add(add, std::memory_order_relaxed);
        };
        points.visit_turns(end, c, size,
                           [&](std::size_t k, int turns) { count(run.first + k, end == 0 ? 0 : 3, turns); });
        points.visit_fork_turns(end, c, size, count);
    }

    // Whether the quads at each vertex of a branch node turn around it once. The cage's vertices come first
    // in the mesh, and each belongs to one node.
    bool turns_once(NodeId n) const {
        bool once = true;
        slices_.for_each_tube_at(n, [&](NodeId t) {
            const CageRun& run = faces_[t.index()].side;
            for (std::uint32_t f = run.first; f < run.first + run.count; ++f)
                once &= turns_[slices_.cage().cage.quads[f][slices_.end_at(t, n) == 1 ? 3 : 0]] == 1;
        });
        const NodeId owner = slices_.fork_tube(n);
        const CageRun& between = faces_[owner.index()].fork[owner == n ? 1 : 0];
        for (std::uint32_t f = between.first; f < between.first + between.count; ++f) {
            for (const std::uint32_t v : slices_.cage().cage.quads[f]) once &= turns_[v] == 1;
        }
        return once;
    }

    // Every tube by itself, and every two whose boxes overlap.
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

    // Whether the star at an end of a tube covers a slice.
    bool covers(NodeId t, int end, std::uint32_t row) const {
        return (end == 0 ? row : slices_.per_tube() - 1 - row) < proof_[t.index()].view[end].clear;
    }

    // Whether the star at an end of a tube covers what two of its slices have to do with each other.
    bool covers(NodeId t, int end, std::uint32_t i, std::uint32_t j) const {
        const bool first = covers(t, end, i), second = covers(t, end, j);
        return (first && second) || (first != second && proof_[t.index()].view[end].is_apart);
    }

    // Slices first .. last that a star about a point on the axis covers, between those that the nodes do.
    std::array<std::uint32_t, 2> own_star(NodeId t, const TubePoints& points) const {
        const Proof& proof = proof_[t.index()];
        const std::uint32_t n = slices_.per_tube();
        if (n < 2 || !points.has_sides()) return {0, 0};
        const std::uint32_t row =
            std::clamp((proof.view[0].clear + n - std::min(n, proof.view[1].clear)) / 2, 1u, n - 1);
        const Vec3d c = points.ring_center(row);
        auto [first, last] = points.clear_about(row, c, farthest(proof.bounds, c));
        // What lies beyond them belongs to the outermost slices.
        if (points.is_closed(0) || points.has_fork(0)) first = std::max(first, 1u);
        if (points.is_closed(1) || points.has_fork(1)) last = std::min(last, n - 1);
        return {first, last};
    }

    // The slices of one tube with each other.
    void compare_slices(NodeId t, Workspace& work) const {
        const Proof& proof = proof_[t.index()];
        const std::uint32_t n = slices_.per_tube();
        const View &begin = proof.view[0], &end = proof.view[1];
        if (proof.is_star || begin.clear == n || end.clear == n) return;
        if (begin.clear + end.clear >= n && (begin.is_apart || end.is_apart)) return;
        Directions d;
        if (!tubes_.is_root(t)) d.set(0, position(t) - position(tubes_.parent(t)));
        work.a.load(faces_[t.index()]);
        work.a.reach(d, work.of_a);
        const auto margin = margins(d, greatest(proof.bounds));
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

    // The ends at which two tubes meet, or -1.
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
        const std::uint32_t n = slices_.per_tube();
        const bool apart_a = end[0] >= 0 && of_a.view[end[0]].is_apart;
        const bool apart_b = end[0] >= 0 && of_b.view[end[1]].is_apart;
        if ((apart_a || (end[0] >= 0 && stays_behind(a, end[0], b, end[1]))) &&
            (apart_b || (end[1] >= 0 && stays_behind(b, end[1], a, end[0]))))
            return;
        const double size = std::max(greatest(of_a.bounds), greatest(of_b.bounds));
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

    // Whether what the star at a node does not cover of tube a has all of b on the other side of a plane
    // across the axis of a. All of b lies about its axis.
    bool stays_behind(NodeId a, int end_a, NodeId b, int end_b) const {
        const Proof &of_a = proof_[a.index()], &of_b = proof_[b.index()];
        const Vec3d away = position(node(a, 1 - end_a)) - position(node(a, end_a));
        const Vec3d way = position(node(b, 1 - end_b)) - position(node(b, end_b));
        const double size = of_a.radius + of_b.radius + length(away) + length(way);
        const double most = std::max(0.0, dot(way, normalized(away))) + of_b.radius;
        return of_a.view[end_a].behind > most + kBeside * size;
    }

    // Whether, along one of the directions, the axes of two tubes are farther apart than both reach from
    // them.
    bool axes_are_apart(NodeId a, NodeId b, const Directions& d, double size) const {
        const auto [a0, a1] = ends(a);
        const auto [b0, b1] = ends(b);
        const double reach = proof_[a.index()].radius + proof_[b.index()].radius + kBeside * size;
        for (std::size_t i = 0; i < Directions::kCount; ++i) {
            const Vec3d w{d.x[i], d.y[i], d.z[i]};
            const double a_low = std::min(dot(w, a0), dot(w, a1)), a_high = std::max(dot(w, a0), dot(w, a1)),
                         b_low = std::min(dot(w, b0), dot(w, b1)), b_high = std::max(dot(w, b0), dot(w, b1));
            const double gap = std::max(a_low - b_high, b_low - a_high);
            if (gap > 0 && gap * gap > reach * reach * length_squared(w)) return true;
        }
        return false;
    }

    // The nodes of a tube; of a ball twice the same.
    std::array<Vec3d, 2> ends(NodeId t) const {
        return {position(tubes_.is_root(t) ? t : tubes_.parent(t)), position(t)};
    }
    Vec3d axis_of(NodeId t) const {
        return tubes_.is_root(t) ? Vec3d{} : normalized(position(t) - position(tubes_.parent(t)));
    }
    Vec3d center(NodeId t) const {
        const auto [from, to] = ends(t);
        return 0.5 * (from + to);
    }

    // Along which two tubes may be told apart.
    Directions directions_between(NodeId a, NodeId b, std::array<int, 2> end) const {
        const Vec3d da = (end[0] == 1 ? -1.0 : 1.0) * axis_of(a),
                    db = (end[1] == 1 ? -1.0 : 1.0) * axis_of(b);
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
    const Slices& slices_;
    const Skeleton& tubes_;
    const Context& ctx_;
    std::span<const TubeFaces> faces_;
    std::vector<Proof> proof_;
    std::vector<std::uint32_t> turns_;  // per vertex of the cage
};

}  // namespace

std::vector<std::uint32_t> unproved_quads(const QuadMesh& mesh, const Slices& slices, const Context& ctx) {
    const auto faces = faces_of_tubes(slices);
    return Search(mesh, slices, faces, ctx).suspects();
}

SliceCrossings slice_crossings(const QuadMesh& mesh, const Slices& slices, const Context& ctx) {
    TubeQuads tubes{mesh, slices, faces_of_tubes(slices), {}};
    Search search(mesh, slices, tubes.faces, ctx);
    std::vector<FacePair> pairs = crossings_among(mesh, search.suspects(), kMostPairs, ctx).pairs;
    tubes.boxes = search.boxes();
    return {std::move(pairs), std::move(tubes)};
}

}  // namespace coppice::pipeline_internal
