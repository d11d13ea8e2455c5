#include "coppice/measure/intersections.h"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/measure/predicates_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kGroupsPerRange = 64;
constexpr std::size_t kRangesPerBatch = 32;
constexpr std::size_t kFaceGrain = 1 << 12;
constexpr std::size_t kPatch = 16;  // number of consecutive faces, which are mostly adjacent
constexpr std::size_t kPairGrain = 256;
constexpr double kNeighbourHops = 3;
constexpr double kNeighbourRadii = 3;
constexpr double kClearance = 1.05;

/// Rotates the corners of t so that corner `k` is first.
Triangle turned(const Triangle& t, int k) { return {t[k], t[(k + 1) % 3], t[(k + 2) % 3]}; }

class PairTest {
  public:
    explicit PairTest(const SurfaceTree& surface) : surface_(surface), x_(surface.mesh().positions) {}

    bool cross(const SurfaceTree::TriangleRun& p, const SurfaceTree::TriangleRun& q) const {
        if (p.face == q.face) return false;
        for (const Triangle& s : surface_.triangles(p)) {
            const Box3 box = compute_box(s);
            for (const Triangle& t : surface_.triangles(q)) {
                if (box.overlaps(compute_box(t)) && cross(s, t)) return true;
            }
        }
        return false;
    }

  private:
    TrianglePoints points(const Triangle& t) const { return {x_[t[0]], x_[t[1]], x_[t[2]]}; }
    Box3 compute_box(const Triangle& t) const {
        Box3 box;
        for (const std::uint32_t v : t) box.extend(x_[v]);
        return box;
    }
    bool cross(const Triangle& s, const Triangle& t) const {
        int shared = 0, i = 0, j = 0, i_free = 3,
            j_free = 3;  // free: the sums of the corners that are not shared
        for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) {
                if (s[a] != t[b]) continue;
                ++shared;
                i = a;
                j = b;
                i_free -= a;
                j_free -= b;
            }
        }
        if (shared == 0) return triangles_meet(points(s), points(t));
        if (shared == 1) return triangles_meet_beyond_corner(points(turned(s, i)), points(turned(t, j)));
        if (shared == 3) return true;
        return triangles_overlap_beyond_edge(points(turned(s, (i_free + 1) % 3)),
                                             points(turned(t, (j_free + 1) % 3)));
    }

    const SurfaceTree& surface_;
    std::span<const Vec3> x_;
};

std::vector<FacePair> crossings_of_groups(const SurfaceTree& surface, IndexRange groups, std::size_t limit) {
    const PairTest test(surface);
    const BoxTree& boxes = surface.boxes();
    std::vector<FacePair> found;
    for (std::size_t g = groups.begin; g < groups.end && found.size() < limit; ++g) {
        boxes.overlaps(static_cast<std::uint32_t>(g), [&](std::uint32_t i, std::uint32_t j) {
            const auto &p = surface.run(boxes.item(i)), &q = surface.run(boxes.item(j));
            if (found.size() >= limit || !test.cross(p, q)) return;
            found.push_back({std::min(p.face, q.face), std::max(p.face, q.face)});
        });
    }
    return found;
}

Vec3d middle(const PolygonMesh& mesh, std::uint32_t face) {
    const auto corners = mesh.face(face);
    Vec3d sum;
    for (const std::uint32_t v : corners) sum += Vec3d(mesh.positions[v]);
    return sum / static_cast<double>(corners.size());
}

/// Returns the segment that a face belongs to.
std::uint32_t compute_capsule(const PolygonMesh& mesh, std::uint32_t face, const CapsuleTree& capsules) {
    return capsules.nearest(middle(mesh, face)).capsule;
}

enum class Kind { local, remote, overlap };

class Classifier {
  public:
    Classifier(const Skeleton& skeleton, const CapsuleTree& capsules)
        : skeleton_(skeleton), capsules_(capsules), depth_(skeleton.size()) {
        for (const NodeId n : nodes(skeleton)) {
            if (const NodeId p = skeleton.parent(n)) depth_[n] = depth_[p] + 1;
        }
    }

    Kind kind(const PolygonMesh& mesh, FacePair pair) const {
        const std::uint32_t i = compute_capsule(mesh, pair.first, capsules_),
                            j = compute_capsule(mesh, pair.second, capsules_);
        if (i == kNoIndex || j == kNoIndex) return Kind::local;
        if (are_neighbours(i, j)) return Kind::local;
        const RoundCone &a = capsules_.cone(i), &b = capsules_.cone(j);
        const SegmentGap g = gap(a, b);
        return g.distance < kClearance * (a.radius(g.s) + b.radius(g.t)) ? Kind::overlap : Kind::remote;
    }

  private:
    /// Walks up from both child nodes to their common ancestor. The length excludes the two segments
    /// themselves.
    bool are_neighbours(std::uint32_t i, std::uint32_t j) const {
        const RoundCone &s = capsules_.cone(i), &t = capsules_.cone(j);
        const double reach = kNeighbourRadii * std::max({s.radius_a, s.radius_b(), t.radius_a, t.radius_b()});
        const NodeId first = capsules_.node(i), second = capsules_.node(j);
        NodeId a = first, b = second;
        int hops = 0;
        double way = 0;
        while (a != b) {
            if (hops > kNeighbourHops && way >= reach) return false;
            NodeId& deeper = depth_[a] >= depth_[b] ? a : b;
            const NodeId parent = skeleton_.parent(deeper);
            if (!parent) return false;
            if (deeper != first && deeper != second) {
                way += distance(Vec3d(skeleton_.position(deeper)), Vec3d(skeleton_.position(parent)));
            }
            deeper = parent;
            ++hops;
        }
        return hops <= kNeighbourHops || way < reach;
    }

    const Skeleton& skeleton_;
    const CapsuleTree& capsules_;
    Column<NodeId, std::uint32_t> depth_;
};

/// Groups pairs by place, the largest group first.
std::vector<std::vector<FacePair>> sort_by_place(const FacePairs& found, const PolygonMesh& mesh) {
    if (found.pairs.empty()) return {};
    DisjointSets sets(mesh.positions.size());
    for (const FacePair& p : found.pairs) {
        const std::uint32_t first = mesh.face(p.first)[0];
        for (const std::uint32_t f : {p.first, p.second}) {
            for (const std::uint32_t v : mesh.face(f)) sets.join(first, v);
        }
    }
    std::vector<std::vector<FacePair>> places;
    std::unordered_map<std::uint32_t, std::size_t> place_of;  // by the representative vertex
    for (const FacePair& p : found.pairs) {
        const auto [at, is_new] = place_of.try_emplace(sets.find(mesh.face(p.first)[0]), places.size());
        if (is_new) places.emplace_back();
        places[at->second].push_back(p);
    }
    std::ranges::stable_sort(places, std::ranges::greater(), &std::vector<FacePair>::size);
    return places;
}

/// Calls visit(face) for both faces of every pair.
template <class Visit>
void for_each_face(std::span<const FacePair> pairs, const Visit& visit) {
    for (const FacePair& p : pairs) {
        visit(p.first);
        visit(p.second);
    }
}

CrossingPlace place_of(std::span<const FacePair> pairs, const PolygonMesh& mesh) {
    CrossingPlace out{.pairs = pairs.size()};
    Vec3d sum;
    for_each_face(pairs, [&](std::uint32_t f) { sum += middle(mesh, f); });
    const Vec3d place = sum / (2 * static_cast<double>(pairs.size()));
    for_each_face(pairs, [&](std::uint32_t f) {
        for (const std::uint32_t v : mesh.face(f))
            out.radius = std::max(out.radius, distance(place, Vec3d(mesh.positions[v])));
    });
    out.place = mesh.origin + place;
    return out;
}

/// Returns the two segments, the smaller index first, to which most of these pairs belong.
std::array<std::uint32_t, 2> compute_capsules(std::span<const FacePair> pairs, const PolygonMesh& mesh,
                                              const CapsuleTree& capsules, const Context& ctx) {
    std::vector<std::array<std::uint32_t, 2>> sides(pairs.size());
    parallel_for(ctx, sides.size(), kPairGrain, [&](std::size_t i) {
        sides[i] = {compute_capsule(mesh, pairs[i].first, capsules),
                    compute_capsule(mesh, pairs[i].second, capsules)};
        std::ranges::sort(sides[i]);
    });
    std::ranges::sort(sides);
    std::array<std::uint32_t, 2> best{};
    std::ptrdiff_t most = 0;
    for (auto at = sides.begin(); at != sides.end();) {
        const auto end = std::upper_bound(at, sides.end(), *at);
        if (end - at > most) {
            most = end - at;
            best = *at;
        }
        at = end;
    }
    return best;
}

/// Returns the end of a segment that is nearer to a place; an invalid id if there is no segment.
NodeId nearer_end(const Skeleton& skeleton, const CapsuleTree& capsules, std::uint32_t i, Vec3d place) {
    if (i == kNoIndex) return {};
    const RoundCone& cone = capsules.cone(i);
    const NodeId end = capsules.node(i), begin = skeleton.parent(end);
    const bool is_begin = begin && distance(place, cone.a) < distance(place, cone.b());
    return is_begin ? begin : end;
}

}  // namespace

FacePairs crossing_faces(const SurfaceTree& surface, std::uint32_t limit, const Context& ctx) {
    FacePairs result;
    const std::size_t groups = surface.boxes().group_count();
    constexpr std::size_t kBatch = kGroupsPerRange * kRangesPerBatch;
    std::vector<std::vector<FacePair>> found(kRangesPerBatch);
    for (std::size_t begin = 0; begin < groups && result.complete; begin += kBatch) {
        ctx.throw_if_cancelled();
        const std::size_t count = std::min(kBatch, groups - begin);
        for (auto& f : found) f.clear();
        // A range may stop at its own limit; the sum over the ranges is limited below.
        parallel_for_ranges(ctx, count, kGroupsPerRange, [&](IndexRange range) {
            const IndexRange shifted{begin + range.begin, begin + range.end};
            found[range.begin / kGroupsPerRange] =
                crossings_of_groups(surface, shifted, std::size_t{limit} + 1);
        });
        for (const auto& f : found) {
            result.pairs.insert(result.pairs.end(), f.begin(), f.end());
            if (result.pairs.size() <= limit) continue;
            result.pairs.resize(limit);
            result.complete = false;
            break;
        }
    }
    sort_unique(result.pairs);
    return result;
}

FacePairs crossings_among(const FaceView& mesh, std::span<const std::uint32_t> faces, std::uint32_t limit,
                          const Context& ctx) {
    if (faces.size() < 2) return {};
    const PolygonMesh part = some_faces(mesh, faces);
    FacePairs found = crossing_faces(SurfaceTree(part, ctx), limit, ctx);
    for (FacePair& p : found.pairs) p = {faces[p.first], faces[p.second]};
    return found;
}

std::vector<std::uint32_t> faces_near(const FaceView& mesh, std::span<const Box3> boxes, const Context& ctx) {
    if (boxes.empty()) return {};
    const BoxTree tree(boxes, ctx);
    std::vector<std::vector<std::uint32_t>> found((mesh.size() + kFaceGrain - 1) / kFaceGrain);
    parallel_for_ranges(ctx, mesh.size(), kFaceGrain, [&](IndexRange range) {
        auto& own = found[range.begin / kFaceGrain];
        for (std::size_t begin = range.begin; begin < range.end; begin += kPatch) {
            const auto first = static_cast<std::uint32_t>(begin);
            const auto end = static_cast<std::uint32_t>(std::min(begin + kPatch, range.end));
            Box3 patch;
            for (std::uint32_t f = first; f < end; ++f) patch.extend(mesh.box(f));
            if (!tree.meets(patch)) continue;
            for (std::uint32_t f = first; f < end; ++f) {
                if (tree.meets(mesh.box(f))) own.push_back(f);
            }
        }
    });
    std::vector<std::uint32_t> faces;
    for (const auto& f : found) faces.insert(faces.end(), f.begin(), f.end());
    return faces;
}

IntersectionReport classify(const FacePairs& found, const PolygonMesh& mesh, const Skeleton* skeleton,
                            const CapsuleTree* capsules, const Context& ctx) {
    IntersectionReport report{.total = found.pairs.size(), .complete = found.complete};
    if (skeleton == nullptr || capsules == nullptr) {
        report.local = report.total;
        return report;
    }
    const Classifier classifier(*skeleton, *capsules);
    std::vector<Kind> kinds(found.pairs.size());
    parallel_for(ctx, kinds.size(), kPairGrain,
                 [&](std::size_t i) { kinds[i] = classifier.kind(mesh, found.pairs[i]); });
    const auto count = [&](Kind k) {
        return static_cast<std::uint64_t>(std::count(kinds.begin(), kinds.end(), k));
    };
    report.local = count(Kind::local);
    report.remote = count(Kind::remote);
    report.overlap = count(Kind::overlap);
    return report;
}

CrossingPlaces crossing_places(const FacePairs& found, const PolygonMesh& mesh, const Skeleton* skeleton,
                               const CapsuleTree* capsules, std::size_t max_named, const Context& ctx) {
    const std::vector<std::vector<FacePair>> places = sort_by_place(found, mesh);
    CrossingPlaces out{.total = places.size()};
    for (std::size_t k = 0; k < std::min(max_named, places.size()); ++k) {
        const std::vector<FacePair>& pairs = places[k];
        CrossingPlace& named = out.largest.emplace_back(place_of(pairs, mesh));
        if (skeleton == nullptr || capsules == nullptr) continue;
        const auto [one, other] = compute_capsules(pairs, mesh, *capsules, ctx);
        const Vec3d place = named.place - mesh.origin;
        named.node = nearer_end(*skeleton, *capsules, one, place);
        named.other_node = nearer_end(*skeleton, *capsules, other, place);
    }
    return out;
}

}  // namespace coppice
