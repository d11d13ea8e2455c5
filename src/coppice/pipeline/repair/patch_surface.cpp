#include "coppice/pipeline/repair/patch_internal.h"

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <numeric>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/measure/intersections.h"
#include "coppice/pipeline/remesh/zip_internal.h"
#include "coppice/pipeline/repair/crossings_internal.h"
#include "coppice/pipeline/repair/grid_corners_internal.h"
#include "coppice/pipeline/stages_internal.h"
#include "coppice/pipeline/tetra_skeleton_internal.h"
#include "coppice/skeleton/segment_cone.h"

namespace coppice::pipeline_internal {
namespace {

constexpr double kMaxTriangles = 1e6;  // in addition to as many as the mesh has quads
constexpr std::size_t kVertexGrain = 1024;
constexpr float kLongestEdge = 1.0f;  // [radii] chords of longer edges are too far from the surface
constexpr float kGap = 0.35f;         // [radii] gap between kept quads and new triangles
constexpr float kDeepest = 2.5f, kHighest = 0.3f, kWidest = 2.5f;  // [radii] range of valid loops
constexpr double kGrowth = 2;                                      // of the number of segments of a level set
constexpr float kSeamReach = 2.2f;  // [radii] maximum distance of loops from the centre of a cut ring

// [radii] Returns the length of edges of triangles that become as large as two quads.
float triangle_edge(const MeshOptions& options) {
    return 4 * std::numbers::pi_v<float> / static_cast<float>(options.control.sides << options.levels);
}

// The same, within the resolution of tetrahedra.
MeshOptions patch_options(const MeshOptions& options) {
    constexpr float kFinest = 0.05f, kCoarsest = 1.0f;
    MeshOptions out = options;
    out.tetra = {.edge = std::clamp(triangle_edge(options), kFinest, kCoarsest)};
    return out;
}

// Returns the approximate number of triangles of a surface around segments.
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

// Returns the closest point to p on a node's segment.
Vec3 closest_axis_position(const Skeleton& s, NodeId n, Vec3 p) {
    if (s.is_root(n)) return s.position(n);
    const auto axis = round_cone<float>(s.segment(n));
    return axis.point(axis.closest_point(p).t);
}

// Returns per vertex whether it is beyond a cut ring, or too close to it. Vertices around an axis other than
// that through the cut ring are ignored.
std::vector<std::uint8_t> beyond_seams(const PatchSurface& surface, std::span<const Vec3> positions,
                                       const BoxTree& reaches, const Context& ctx) {
    std::vector<std::uint8_t> beyond(positions.size(), 0);
    parallel_for(ctx, beyond.size(), kVertexGrain, [&](std::size_t v) {
        const NodeId near = surface.near[surface.ring_vertices + v];
        if (!near) {
            beyond[v] = surface.marched->closest_axis_point[v].segment ? 1 : 0;
            return;
        }
        const Vec3 p = positions[v];
        bool is_beyond = surface.patch_skeleton.margin[near.index()] != 0;
        reaches.visit_overlapping(Box3{p, p}, [&](std::uint32_t i) {
            const CutRing& s = surface.group.cut_rings[i];
            const float reach = kSeamReach * s.radius;
            const Vec3 way = p - s.center;
            if (length_squared(way) >= reach * reach || dot(way, s.outward) <= -kGap * s.radius) return;
            const Vec3 closest = closest_axis_position(surface.patch_skeleton.skeleton, near, p) - s.center;
            is_beyond |= length(closest - s.outward * dot(closest, s.outward)) < s.radius;
        });
        beyond[v] = is_beyond ? 1 : 0;
    });
    return beyond;
}

// The remainder of a surface after cutting.
struct Cut {
    std::vector<Triangle> triangles;
    Boundary ends;  // with the same vertex indices
};

// Returns the triangles without a vertex that is marked in `beyond`, except those at vertices where loops
// would touch. Vertex indices are increased by `offset`.
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
        out.ends = compute_boundary(out.triangles, rim);
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

// Returns whether a loop is far from the expected position at its cut ring because another branch is in
// between.
bool strays(const Loop& loop, std::span<const Vec3> x, const CutRing& cut_ring) {
    return std::any_of(loop.begin(), loop.end(), [&](std::uint32_t v) {
        const Vec3 way = x[v] - cut_ring.center;
        const float height = dot(way, cut_ring.outward);
        return height < -kDeepest * cut_ring.radius || height > kHighest * cut_ring.radius ||
               length(way - cut_ring.outward * height) > kWidest * cut_ring.radius;
    });
}

// Joins the boundary loops of a surface to the cut rings around which they run.
class Joining {
  public:
    Joining(PatchSurface& surface, Boundary ends, const BoxTree& reaches)
        : surface_(surface), ends_(std::move(ends)), marked_(ends_.loops.size(), 0) {
        loops_of_.resize(surface.group.cut_rings.size());
        for (std::uint32_t l = 0; l < ends_.loops.size(); ++l) {
            const Vec3 c = mean(ends_.loops[l], surface.positions);
            reaches.visit_overlapping(Box3{c, c}, [&](std::uint32_t s) { loops_of_[s].push_back(l); });
        }
    }

    void run() && {
        std::uint32_t first = 0;
        for (std::uint32_t i = 0; i < surface_.group.cut_rings.size(); ++i) {
            const CutRing& cut_ring = surface_.group.cut_rings[i];
            // Every second vertex: between them are the midpoints that quadrangulate() expects.
            Loop coarse;
            for (std::uint32_t k = 0; k < cut_ring.ring.size(); k += 2) coarse.push_back(first + k);
            first += static_cast<std::uint32_t>(cut_ring.ring.size());
            if (!join(i, coarse)) surface_.failed.push_back(i);
        }
        if (surface_.failed.empty()) drop_crumbs();
        surface_.cut_ring.assign(surface_.triangles.size(), kNoIndex);
        surface_.triangles.insert(surface_.triangles.end(), bands_.begin(), bands_.end());
        surface_.cut_ring.insert(surface_.cut_ring.end(), seam_.begin(), seam_.end());
    }

  private:
    bool join(std::uint32_t i, const Loop& ring) {
        const CutRing& cut_ring = surface_.group.cut_rings[i];
        const LoopAxis axis{cut_ring.center, cut_ring.outward};
        std::uint32_t best = kNoIndex;
        float least = kSeamReach * cut_ring.radius;
        for (const std::uint32_t l : loops_of_[i]) {
            const float d = distance(mean(ends_.loops[l], surface_.positions), cut_ring.center);
            if (marked_[l] != 0 || d >= least || winding(ends_.loops[l], surface_.positions, axis) == 0)
                continue;
            least = d;
            best = l;
        }
        if (best == kNoIndex) return false;
        if (strays(ends_.loops[best], surface_.positions, cut_ring)) return false;
        const auto band = zip(ring, ends_.loops[best], surface_.positions, axis);
        if (!band) return false;
        marked_[best] = 1;
        bands_.insert(bands_.end(), band->begin(), band->end());
        seam_.resize(bands_.size(), i);
        return true;
    }

    // Bodies that are not joined to a cut ring are whole trees, internal voids, or fragments; a body that is
    // joined to a cut ring must not have another hole.
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
        for (std::size_t l = 0; l < marked_.size(); ++l) {
            is[bodies.find(ends_.loops[l][0])] |= marked_[l] != 0 ? kJoined : kOpen;
        }
        for (std::size_t l = 0; l < marked_.size(); ++l) {
            if (marked_[l] != 0 || is[bodies.find(ends_.loops[l][0])] != (kJoined | kOpen)) continue;
            surface_.beyond.push_back(row_beyond(mean(ends_.loops[l], x)));
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

    // Returns the row of the closest segment beyond the cut rings.
    TubeRow row_beyond(Vec3 p) const {
        const Skeleton& s = surface_.patch_skeleton.skeleton;
        double least = std::numeric_limits<double>::infinity();
        TubeRow nearest = kNoIndex;
        for (const NodeId n : nodes(s)) {
            if (surface_.patch_skeleton.margin[n.index()] == 0 || s.is_root(n)) continue;
            const double d = round_cone<double>(s.segment(n)).closest_point(Vec3d(p)).signed_distance();
            if (d >= least) continue;
            least = d;
            nearest = surface_.patch_skeleton.tube_row[n.index()];
        }
        return nearest;
    }

    PatchSurface& surface_;
    Boundary ends_;
    std::vector<std::uint8_t> marked_;                  // per loop: whether it is assigned to a cut ring
    std::vector<std::vector<std::uint32_t>> loops_of_;  // per cut ring: the loops in its reach
    std::vector<Triangle> bands_;
    std::vector<std::uint32_t> seam_;  // per triangle of the bands
};

// The row of each triangle is that of one of its vertices.
void find_slices(PatchSurface& surface) {
    surface.tube_row.assign(surface.triangles.size(), kNoIndex);
    for (std::size_t t = 0; t < surface.tube_row.size(); ++t) {
        for (const std::uint32_t v : surface.triangles[t]) {
            if (surface.near[v])
                surface.tube_row[t] = surface.patch_skeleton.tube_row[surface.near[v].index()];
        }
    }
}

std::vector<AxisPoint> find_closest_axis_points(const PatchSkeleton& patch_skeleton,
                                                std::span<const Vec3> positions, const Context& ctx) {
    std::vector<NodeId> segment(patch_skeleton.skeleton.size());
    for (const PatchSkeleton::Cut& cut : patch_skeleton.cuts)
        std::fill_n(segment.begin() + cut.first, cut.count, cut.segment);
    const CapsuleTree capsules(patch_skeleton.skeleton, patch_skeleton.skeleton.origin(), ctx);
    std::vector<AxisPoint> out(positions.size());
    const auto point = [&](std::size_t v) { return Vec3d(positions[v]); };
    for_each_nearest(capsules, ctx, out.size(), point, [&](std::size_t v, CapsuleTree::Nearest near) {
        if (near.capsule == kNoIndex) return;
        const std::uint32_t n = capsules.node(near.capsule).index();
        // A section begins where the previous one ends.
        const bool is_first = n == 0 || segment[n - 1] != segment[n];
        const float begin = is_first ? 0 : patch_skeleton.until[n - 1];
        const auto closest = capsules.cone(near.capsule).closest_point(point(v));
        const auto t = static_cast<float>(closest.t);
        out[v] = {segment[n], begin + t * (patch_skeleton.until[n] - begin),
                  static_cast<float>(closest.radius)};
    });
    return out;
}

std::vector<Segment> collect_segments(const Skeleton& s) {
    std::vector<Segment> out;
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n)) out.push_back(s.segment(n));
    }
    return out;
}

// Returns boxes around some triangles, inflated by their own size.
Box3 box_around(const TriMesh& mesh, std::initializer_list<std::uint32_t> triangles) {
    Box3 box;
    for (const std::uint32_t t : triangles) {
        for (const std::uint32_t v : mesh.triangles[t]) box.extend(mesh.positions[v]);
    }
    return box.inflated(box.diagonal());
}

std::vector<Box3> find_intersections(const TriMesh& mesh, const Context& ctx) {
    std::vector<Box3> out;
    const PolygonMesh faces = to_polygons(mesh);
    for (const FacePair& pair : crossing_faces(SurfaceTree(faces, ctx), kMaxPairs, ctx).pairs)
        out.push_back(box_around(mesh, {pair.first, pair.second}));
    return out;
}

// Returns boxes around triangles that are turned away from the normals of the level set.
std::vector<Box3> find_turned(const TriMesh& mesh, std::span<const GridCorner> corners,
                              std::span<const std::uint32_t> kept) {
    constexpr double kMinCosine = 0.5;
    std::vector<Box3> out;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle& triangle = mesh.triangles[t];
        const auto point = [&](std::size_t k) { return Vec3d(mesh.positions[triangle[k]]); };
        const Vec3d normal = normalized(cross(point(1) - point(0), point(2) - point(0)));
        const bool is_turned = std::ranges::any_of(triangle, [&](std::uint32_t v) {
            return dot(normal, Vec3d(corners[kept[v]].normal)) < kMinCosine;
        });
        if (is_turned) out.push_back(box_around(mesh, {t}));
    }
    return out;
}

// Makes triangles of the size of quads, with corners on grids around the axes. Where triangles are
// turned or intersect, grids do not fit together, and only short edges are collapsed. If that intersects too,
// triangles keep their size, so that planar quads of its triangles never intersect.
void coarsen(Marched& marched, const PatchSkeleton& patch_skeleton, float edge, const Context& ctx) {
    constexpr int kAttempts = 3;
    std::vector<GridCorner> corners = compute_grid_corners(marched, patch_skeleton, edge, ctx);
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        TriMesh coarse = marched.mesh;
        const std::vector<std::uint32_t> kept = coarsen_triangles(coarse, corners);
        std::vector<Box3> faults = find_intersections(coarse, ctx);
        if (attempt == 0) {
            const std::vector<Box3> turned = find_turned(coarse, corners, kept);
            faults.insert(faults.end(), turned.begin(), turned.end());
        }
        if (faults.empty()) {
            marched.mesh = std::move(coarse);
            for (std::size_t v = 0; v < kept.size(); ++v)
                marched.closest_axis_point[v] = marched.closest_axis_point[kept[v]];
            marched.closest_axis_point.resize(kept.size());
            return;
        }
        const BoxTree around(faults, ctx);
        parallel_for(ctx, corners.size(), kVertexGrain, [&](std::size_t v) {
            const Vec3 p = marched.mesh.positions[v];
            around.visit_overlapping(Box3{p, p}, [&](std::uint32_t) {
                corners[v].position = p;
                if (attempt > 0) corners[v].spacing = 0;
            });
        });
    }
}

std::shared_ptr<const Marched> march(const PatchSkeleton& patch_skeleton, const QuadMesh& mesh,
                                     const MeshOptions& options, const Context& ctx) {
    Marched out;
    for (const PatchSkeleton::Cut& cut : patch_skeleton.cuts) out.segments.push_back(cut.segment);
    const MeshOptions by_tetrahedra = patch_options(options);
    out.is_impossible = !can_march(collect_segments(patch_skeleton.skeleton), mesh, options);
    if (!out.is_impossible) {
        try {
            std::optional<GlobalWeights> weights;
            std::vector<std::pair<std::string, double>> seconds;
            Stages stages(ctx, seconds);
            out.mesh =
                mesh_by_tetrahedra(patch_skeleton.skeleton, PointSet{}, by_tetrahedra, weights, ctx, stages)
                    .mesh;
            out.closest_axis_point = find_closest_axis_points(patch_skeleton, out.mesh.positions, ctx);
            coarsen(out, patch_skeleton, std::min(triangle_edge(options), kLongestEdge), ctx);
        } catch (const Cancelled&) {
            throw;
        } catch (const Error&) {
            // No surface is left because it is thinner than the tetrahedra: the quads are better than that.
            out.is_impossible = true;
        }
    }
    return std::make_shared<const Marched>(std::move(out));
}

// Returns a close node per vertex: none for the rings, then those of the vertices of the level set.
std::vector<NodeId> nodes_near(const PatchSurface& surface) {
    std::vector<NodeId> out(surface.ring_vertices);
    for (const AxisPoint& p : surface.marched->closest_axis_point)
        out.push_back(p.segment ? surface.patch_skeleton.node_at(p.segment, p.t) : NodeId::none());
    return out;
}

}  // namespace

bool Marched::contains(std::span<const NodeId> some) const { return std::ranges::includes(segments, some); }

bool can_march(std::span<const Segment> segments, const QuadMesh& mesh, const MeshOptions& options) {
    return expected_triangles(segments, patch_options(options).tetra.edge) <=
           kMaxTriangles + static_cast<double>(mesh.quads.size());
}

PatchSurface patch_surface(RowGroup group, std::shared_ptr<const Marched> marched,
                           const PatchSkeletons& skeletons, const QuadMesh& mesh, const MeshOptions& options,
                           const Context& ctx) {
    const bool is_enough = marched && marched->contains(skeletons.needed(group));
    // A group that has outgrown its level set grows again: its next one is larger by a factor, so that all
    // level sets together cost only a constant factor more than the last one.
    const auto count =
        marched && !is_enough ? static_cast<std::size_t>(kGrowth * marched->segments.size()) : 0;
    PatchSkeleton patch_skeleton = skeletons.of(group, count);
    PatchSurface surface{std::move(group), std::move(patch_skeleton), std::move(marched)};
    if (!is_enough) {
        surface.marched = march(surface.patch_skeleton, mesh, options, ctx);
    }
    surface.is_impossible = surface.marched->is_impossible;
    if (surface.is_impossible) return surface;

    std::vector<Box3> boxes;
    for (const CutRing& s : surface.group.cut_rings)
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
