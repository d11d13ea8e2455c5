#include "coppice/pipeline/knots/knot_patch_internal.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <numeric>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/parallel.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/pipeline/stages_internal.h"
#include "coppice/pipeline/tetra_skeleton_internal.h"
#include "coppice/remesh/zip.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice::pipeline_internal {
namespace {

constexpr double kMostTriangles = 1e6;  // besides as many as the mesh has quads
constexpr std::size_t kVertexGrain = 1024;
constexpr float kGap = 0.35f;  // [radii] between the quads that stay and the triangles that come
constexpr float kDeepest = 2.5f, kHighest = 0.3f, kWidest = 2.5f;  // [radii] within which loops run
constexpr float kSeamReach = 2.2f;  // [radii] how far from a seam's centre its loops lie

// Triangles as large as two quads, within what tetrahedra resolve.
MeshOptions patch_options(const MeshOptions& options) {
    constexpr float kFinest = 0.05f, kCoarsest = 1.0f;
    MeshOptions out = options;
    const auto around = static_cast<float>(options.control.sides << options.levels);
    out.tetra = {.edge = std::clamp(4 * std::numbers::pi_v<float> / around, kFinest, kCoarsest)};
    return out;
}

// Triangles of a surface about segments, roughly.
double expected_triangles(std::span<const Segment> segments, float edge) {
    double area = 0;  // in squares of the local edge
    for (const Segment& segment : segments) {
        const auto radius = static_cast<double>(std::min(segment.radius_a, segment.radius_b));
        area += static_cast<double>(distance(segment.a, segment.b)) / radius * 2 * std::numbers::pi;
    }
    constexpr double kOfASquare = 4 / std::numbers::sqrt3;
    return area * kOfASquare / static_cast<double>(edge * edge);
}

Vec3 mean(const Loop& loop, std::span<const Vec3> x) {
    Vec3 sum;
    for (const std::uint32_t v : loop) sum += x[v];
    return sum / static_cast<float>(loop.size());
}

// The point of a node's segment that is nearest to p.
Vec3 foot_on(const Skeleton& s, NodeId n, Vec3 p) {
    if (s.is_root(n)) return s.position(n);
    const auto axis = round_cone<float>(s.segment(n));
    return axis.point(axis.foot(p).t);
}

// Whether vertices lie beyond a seam, or too near to it. What is about another axis than the one through the
// seam only passes by.
std::vector<std::uint8_t> beyond_seams(const KnotSurface& surface, std::span<const Vec3> positions,
                                       const BoxTree& reaches, const Context& ctx) {
    std::vector<std::uint8_t> beyond(positions.size(), 0);
    parallel_for(ctx, beyond.size(), kVertexGrain, [&](std::size_t v) {
        const NodeId near = surface.near[surface.ring_vertices + v];
        if (!near) {
            beyond[v] = surface.marched->foot[v].segment ? 1 : 0;
            return;
        }
        const Vec3 p = positions[v];
        bool is_beyond = surface.knot.margin[near.index()] != 0;
        reaches.visit_overlapping(Box3{p, p}, [&](std::uint32_t i) {
            const Seam& s = surface.group.seams[i];
            const float reach = kSeamReach * s.radius;
            const Vec3 way = p - s.center;
            if (length_squared(way) >= reach * reach || dot(way, s.outward) <= -kGap * s.radius) return;
            const Vec3 foot = foot_on(surface.knot.skeleton, near, p) - s.center;
            is_beyond |= length(foot - s.outward * dot(foot, s.outward)) < s.radius;
        });
        beyond[v] = is_beyond ? 1 : 0;
    });
    return beyond;
}

// What is left of a surface that was cut off.
struct Cut {
    std::vector<Triangle> triangles;
    Boundary ends;  // in the same numbers of vertices
};

// The triangles without a vertex that is marked in `beyond`, less those at vertices where loops would touch.
// Vertices become `offset` more.
Cut cut_off(const TriMesh& mesh, std::vector<std::uint8_t> beyond, std::uint32_t offset) {
    std::vector<std::uint8_t> rim(mesh.positions.size(), 0);
    const auto is_beyond = [&](const Triangle& t) {
        return (beyond[t[0]] | beyond[t[1]] | beyond[t[2]]) != 0;
    };
    const auto drop = [&](const Triangle& t) {
        for (const std::uint32_t v : t) rim[v] = 1;
    };
    Cut out;
    for (const Triangle& t : mesh.triangles) {
        if (is_beyond(t)) {
            drop(t);
        } else {
            out.triangles.push_back(t);
        }
    }
    for (;;) {
        out.ends = boundary_of(out.triangles, rim);
        if (out.ends.pinched.empty()) break;
        for (const std::uint32_t v : out.ends.pinched) beyond[v] = 1;
        std::erase_if(out.triangles, [&](const Triangle& t) {
            if (!is_beyond(t)) return false;
            drop(t);
            return true;
        });
    }
    for (Triangle& t : out.triangles) {
        for (std::uint32_t& v : t) v += offset;
    }
    for (Loop& loop : out.ends.loops) {
        for (std::uint32_t& v : loop) v += offset;
    }
    return out;
}

// Whether a loop runs far from where its seam wants it: another branch is in the way.
bool strays(const Loop& loop, std::span<const Vec3> x, const Seam& seam) {
    return std::any_of(loop.begin(), loop.end(), [&](std::uint32_t v) {
        const Vec3 way = x[v] - seam.center;
        const float height = dot(way, seam.outward);
        return height < -kDeepest * seam.radius || height > kHighest * seam.radius ||
               length(way - seam.outward * height) > kWidest * seam.radius;
    });
}

// Joins the loops at which a surface ends to the seams that they go around.
class Joining {
  public:
    Joining(KnotSurface& surface, Boundary ends, const BoxTree& reaches)
        : surface_(surface), ends_(std::move(ends)), taken_(ends_.loops.size(), 0) {
        loops_of_.resize(surface.group.seams.size());
        for (std::uint32_t l = 0; l < ends_.loops.size(); ++l) {
            const Vec3 c = mean(ends_.loops[l], surface.positions);
            reaches.visit_overlapping(Box3{c, c}, [&](std::uint32_t s) { loops_of_[s].push_back(l); });
        }
    }

    void run() && {
        std::uint32_t first = 0;
        for (std::uint32_t i = 0; i < surface_.group.seams.size(); ++i) {
            const Seam& seam = surface_.group.seams[i];
            // Every second vertex: between them lie the middles that quadrangulate() is given.
            Loop coarse;
            for (std::uint32_t k = 0; k < seam.ring.size(); k += 2) coarse.push_back(first + k);
            first += static_cast<std::uint32_t>(seam.ring.size());
            if (!join(i, coarse)) surface_.failed.push_back(i);
        }
        if (surface_.failed.empty()) drop_crumbs();
        surface_.seam.assign(surface_.triangles.size(), kNoSeam);
        surface_.triangles.insert(surface_.triangles.end(), bands_.begin(), bands_.end());
        surface_.seam.insert(surface_.seam.end(), seam_.begin(), seam_.end());
    }

  private:
    bool join(std::uint32_t i, const Loop& ring) {
        const Seam& seam = surface_.group.seams[i];
        const LoopAxis axis{seam.center, seam.outward};
        std::uint32_t best = kNoSeam;
        float least = kSeamReach * seam.radius;
        for (const std::uint32_t l : loops_of_[i]) {
            const float d = distance(mean(ends_.loops[l], surface_.positions), seam.center);
            if (taken_[l] != 0 || d >= least || winding(ends_.loops[l], surface_.positions, axis) == 0)
                continue;
            least = d;
            best = l;
        }
        if (best == kNoSeam) return false;
        if (strays(ends_.loops[best], surface_.positions, seam)) return false;
        const auto band = zip(ring, ends_.loops[best], surface_.positions, axis);
        if (!band) return false;
        taken_[best] = 1;
        bands_.insert(bands_.end(), band->begin(), band->end());
        seam_.resize(bands_.size(), i);
        return true;
    }

    // Bodies that no seam joins are whole trees, or voids within, or crumbs; a body that a seam joins may
    // have no other hole.
    void drop_crumbs() {
        std::vector<Triangle>& all = surface_.triangles;
        std::span<const Vec3> x = surface_.positions;
        DisjointSets bodies(x.size());
        for (const Triangle& t : all) {
            bodies.join(t[0], t[1]);
            bodies.join(t[1], t[2]);
        }
        enum : std::uint8_t { kJoined = 1, kOpen = 2 };
        std::vector<std::uint8_t> is(x.size(), 0);
        for (std::size_t l = 0; l < taken_.size(); ++l) {
            is[bodies.find(ends_.loops[l][0])] |= taken_[l] != 0 ? kJoined : kOpen;
        }
        for (std::size_t l = 0; l < taken_.size(); ++l) {
            if (taken_[l] != 0 || is[bodies.find(ends_.loops[l][0])] != (kJoined | kOpen)) continue;
            surface_.beyond.push_back(slice_beyond(mean(ends_.loops[l], x)));
        }
        std::vector<double> volume(x.size(), 0);
        for (const Triangle& t : all) {
            volume[bodies.find(t[0])] += dot(Vec3d(x[t[0]]), cross(Vec3d(x[t[1]]), Vec3d(x[t[2]])));
        }
        std::erase_if(all, [&](const Triangle& t) {
            const std::uint32_t body = bodies.find(t[0]);
            return (is[body] & kJoined) == 0 && (is[body] == kOpen || volume[body] <= 0);
        });
    }

    // That of the nearest segment beyond the seams.
    Slice slice_beyond(Vec3 p) const {
        const Skeleton& s = surface_.knot.skeleton;
        double least = std::numeric_limits<double>::infinity();
        Slice nearest = Slices::kNone;
        for (const NodeId n : nodes(s)) {
            if (surface_.knot.margin[n.index()] == 0 || s.is_root(n)) continue;
            const double d = round_cone<double>(s.segment(n)).foot(Vec3d(p)).signed_distance();
            if (d >= least) continue;
            least = d;
            nearest = surface_.knot.slice[n.index()];
        }
        return nearest;
    }

    KnotSurface& surface_;
    Boundary ends_;
    std::vector<std::uint8_t> taken_;                   // per loop: whether a seam has it
    std::vector<std::vector<std::uint32_t>> loops_of_;  // per seam: those in its reach
    std::vector<Triangle> bands_;
    std::vector<std::uint32_t> seam_;  // per triangle of the bands
};

// Each triangle is where one of its vertices is.
void find_slices(KnotSurface& surface) {
    surface.slice.assign(surface.triangles.size(), Slices::kNone);
    for (std::size_t t = 0; t < surface.slice.size(); ++t) {
        for (const std::uint32_t v : surface.triangles[t]) {
            if (surface.near[v]) surface.slice[t] = surface.knot.slice[surface.near[v].index()];
        }
    }
}

std::vector<AxisPoint> feet(const KnotSkeleton& knot, std::span<const Vec3> positions, const Context& ctx) {
    std::vector<NodeId> segment(knot.skeleton.size());
    for (const KnotSkeleton::Cut& cut : knot.cuts)
        std::fill_n(segment.begin() + cut.first, cut.count, cut.segment);
    const CapsuleTree capsules(knot.skeleton, knot.skeleton.origin(), ctx);
    std::vector<AxisPoint> out(positions.size());
    const auto point = [&](std::size_t v) { return Vec3d(positions[v]); };
    for_each_nearest(capsules, ctx, out.size(), point, [&](std::size_t v, CapsuleTree::Nearest near) {
        if (near.capsule == CapsuleTree::kNone) return;
        const std::uint32_t n = capsules.node(near.capsule).index();
        // A part begins where the one before it ends.
        const bool is_first = n == 0 || segment[n - 1] != segment[n];
        const float begin = is_first ? 0 : knot.until[n - 1];
        const auto t = static_cast<float>(capsules.cone(near.capsule).foot(point(v)).t);
        out[v] = {segment[n], begin + t * (knot.until[n] - begin)};
    });
    return out;
}

std::vector<Segment> segments_of(const Skeleton& s) {
    std::vector<Segment> out;
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n)) out.push_back(s.segment(n));
    }
    return out;
}

std::shared_ptr<const Marched> march(const KnotSkeleton& knot, const QuadMesh& mesh,
                                     const MeshOptions& options, const Context& ctx) {
    Marched out;
    for (const KnotSkeleton::Cut& cut : knot.cuts) out.segments.push_back(cut.segment);
    const MeshOptions by_tetrahedra = patch_options(options);
    out.is_impossible = !can_march(segments_of(knot.skeleton), mesh, options);
    if (!out.is_impossible) {
        try {
            std::optional<GlobalWeights> weights;
            std::vector<std::pair<std::string, double>> seconds;
            Stages stages(ctx, seconds);
            out.mesh =
                mesh_by_tetrahedra(knot.skeleton, PointSet{}, by_tetrahedra, weights, ctx, stages).mesh;
            out.foot = feet(knot, out.mesh.positions, ctx);
        } catch (const Cancelled&) {
            throw;
        } catch (const Error&) {
            // Nothing is left of a surface that is thinner than the tetrahedra: the quads are better than
            // that.
            out.is_impossible = true;
        }
    }
    return std::make_shared<const Marched>(std::move(out));
}

bool holds(std::span<const NodeId> all, std::span<const NodeId> some) {
    return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

// Per vertex of the rings none, and then per vertex of what was marched.
std::vector<NodeId> nodes_near(const KnotSurface& surface) {
    std::vector<NodeId> out(surface.ring_vertices);
    for (const AxisPoint& p : surface.marched->foot)
        out.push_back(p.segment ? surface.knot.node_at(p.segment, p.t) : NodeId::none());
    return out;
}

}  // namespace

bool can_march(std::span<const Segment> segments, const QuadMesh& mesh, const MeshOptions& options) {
    return expected_triangles(segments, patch_options(options).tetra.edge) <=
           kMostTriangles + static_cast<double>(mesh.quads.size());
}

KnotSurface knot_surface(KnotGroup group, std::shared_ptr<const Marched> marched,
                         const KnotSkeletons& skeletons, const QuadMesh& mesh, const MeshOptions& options,
                         const Context& ctx) {
    const bool is_first = marched == nullptr;
    const bool is_enough = !is_first && holds(marched->segments, skeletons.needed(group));
    KnotSkeleton knot = skeletons.of(group, !is_first);
    KnotSurface surface{std::move(group), std::move(knot), std::move(marched)};
    if (!is_enough) {
        surface.marched = march(surface.knot, mesh, options, ctx);
    }
    surface.is_impossible = surface.marched->is_impossible;
    if (surface.is_impossible) return surface;

    std::vector<Box3> boxes;
    for (const Seam& s : surface.group.seams)
        boxes.push_back(Box3{s.center, s.center}.inflated(kSeamReach * s.radius));
    for (const std::uint32_t v : ring_vertices(surface.group)) surface.positions.push_back(mesh.positions[v]);
    surface.ring_vertices = static_cast<std::uint32_t>(surface.positions.size());
    const BoxTree reaches(boxes, ctx);
    const TriMesh& found = surface.marched->mesh;
    surface.near = nodes_near(surface);
    Cut cut = cut_off(found, beyond_seams(surface, found.positions, reaches, ctx), surface.ring_vertices);
    surface.triangles = std::move(cut.triangles);
    surface.positions.insert(surface.positions.end(), found.positions.begin(), found.positions.end());
    Joining(surface, std::move(cut.ends), reaches).run();
    if (surface.is_whole()) find_slices(surface);
    return surface;
}

}  // namespace coppice::pipeline_internal
