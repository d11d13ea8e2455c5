#include "coppice/pipeline/deform/skinned_mesh.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/pipeline/deform/faults_internal.h"
#include "coppice/pipeline/deform/node_binding_internal.h"
#include "coppice/pipeline/deform/skin_internal.h"
#include "coppice/pipeline/field_regions_internal.h"
#include "coppice/pipeline/fit/kept_quads_internal.h"
#include "coppice/pipeline/quads/built_mesh_internal.h"

namespace coppice {

using namespace pipeline_internal;

namespace {

constexpr std::uint32_t kMaxCrossings = 1u << 20;
constexpr std::size_t kSkinnedMeshGrain = 4096;
constexpr std::size_t kRegionGrain = 64;
constexpr float kLongestWay = 0.5f;  // of the distance from the anchor: maximum displacement onto the field
constexpr float kOnField = 0.002f;   // of the way from the anchor: tolerance for vertices on the field

void check(const MeshOptions& options) {
    if (options.method != MeshMethod::quads)
        throw InvalidInput(
            "animate: method must be quads, because only their vertices are bound to segments");
    if (options.field.weights != Weights::local)
        throw InvalidInput("animate: weights must be local; global weights are those of a single pose");
    if (options.overlaps == Overlaps::apart)
        throw InvalidInput(
            "animate: overlaps must not be apart, which poses do not include; bend the trees apart first, as "
            "with: coppice edit TREES apart -o APART.json");
}

// Returns the region of each vertex of a refined cage: that of the cage quad that owns the vertex.
std::vector<std::uint32_t> find_regions(const QuadBuild& build) {
    std::vector<std::uint32_t> out;
    for (const std::uint32_t f : build.refinement.owners())
        out.push_back(f == kNoIndex ? kNoIndex : build.cage.region[f]);
    return out;
}

}  // namespace

class SkinnedMesh::Body {
  public:
    Body(const Skeleton& skeleton, const MeshOptions& options, const Context& ctx)
        : Body(skeleton, build_mesh(skeleton, (check(options), options), ctx), ctx) {}

    SkinnedFrame deform(const Pose& pose, std::span<const std::uint32_t> stiff, const Context& ctx);
    std::vector<std::uint32_t> at_fault(const SkinnedFrame& frame) const;

    void mark_movers(std::uint32_t face, std::span<std::uint8_t> is_mover) const {
        if (component_[face] == kNoIndex) return mark_face_movers(face, is_mover);
        NodeId last;
        for (const std::uint32_t f : components_[component_[face]]) {
            mark_face_movers(f, is_mover);
            if (last) freeze_between(rest, last, mover(f), is_mover);
            last = mover(f);
        }
    }
    NodeId mover(std::uint32_t face) const {
        return nodes_.segment(NodeId(influences_[made.quads().mesh.quads[face][0]].segment[0]));
    }

    Skeleton rest;
    MeshResult made;

  private:
    Body(const Skeleton& skeleton, BuiltMesh built, const Context& ctx)
        : rest(skeleton),
          made(std::move(built.result)),
          build_(std::move(built.build)),
          field_(build_.skeleton),
          nodes_(skeleton, field_, ctx),
          moved_(to_polygons(mesh())),
          faces_of_(compress_rows<std::uint32_t>(mesh().positions.size(),
                                                 [&](const auto& put) {
                                                     for (std::uint32_t f = 0; f < mesh().quads.size(); ++f) {
                                                         for (const std::uint32_t v : mesh().quads[f])
                                                             put(v, f);
                                                     }
                                                 })),
          kept_(build_, ctx) {
        bind(ctx);
        find_pieces();
        const Buffer<Vec3>& positions = mesh().positions;
        rest_folded_ = folded_faces(mesh().quads, positions, ctx);
        rest_crossings_ = crossings(positions, build_.tubes, ctx);
        find_free(ctx);
    }

    void mark_face_movers(std::uint32_t face, std::span<std::uint8_t> is_mover) const {
        for (const std::uint32_t v : mesh().quads[face]) {
            const Influence& by = influences_[v];
            for (std::size_t i = 0; i < by.segment.size() && by.weight[i] > 0; ++i) {
                const NodeId n(by.segment[i]);
                const NodeId from = field_.is_root(n) ? n : field_.parent(n);
                is_mover[nodes_.segment(n).index()] = 1;
                freeze_between(rest, nodes_.segment(n), nodes_.segment(from), is_mover);
            }
        }
    }
    const QuadMesh& mesh() const { return made.quads().mesh; }

    /// Returns the refined vertex that a vertex of the mesh is; kNoIndex for those of repair patches, and for
    /// all vertices of a fitted mesh, which are not on the field.
    std::uint32_t refined_vertex(std::uint32_t v) const {
        const std::span<const std::uint32_t> kept = kept_.vertices();
        return v < kept.size() && build_.options.fit != Fit::volume ? kept[v] : kNoIndex;
    }
    void bind(const Context& ctx);
    struct MovedPoints {
        Buffer<Vec3> anchors, positions;
        std::vector<SegmentMove> moves;
    };
    /// Moves all points with the segments, without projection.
    MovedPoints carry_to(const Skeleton& now, std::span<const Rotation> turns, const Context& ctx) const;
    void find_pieces();
    void find_free(const Context& ctx);
    ProjectReport project_onto(const Skeleton& now, std::span<const Vec3> anchors, std::span<Vec3> positions,
                               const Context& ctx) const;
    std::vector<FacePair> crossings(std::span<const Vec3> positions, const Skeleton& tubes,
                                    const Context& ctx);
    Skeleton moved_tubes(std::span<const SegmentMove> moves) const;

    QuadBuild build_;
    const Skeleton& field_;  // of the build
    NodeBinding nodes_;
    PolygonMesh moved_;  // the faces, for the search for crossings
    CompressedRows<std::uint32_t> faces_of_;
    KeptQuads kept_;
    Buffer<Vec3> anchors_;
    Buffer<Influence> influences_;
    CompressedRows<std::uint32_t> free_;        // by region of the field: vertices that are projected
    std::vector<std::uint32_t> component_;      // per remeshed face: its connected component
    CompressedRows<std::uint32_t> components_;  // their faces
    std::vector<std::uint32_t> rest_folded_;
    std::vector<FacePair> rest_crossings_;
};

void SkinnedMesh::Body::bind(const Context& ctx) {
    const ControlMesh& cage = build_.cage;
    const std::vector<std::uint32_t> refined_region = find_regions(build_);
    const CapsuleTree capsules(field_, field_.origin(), ctx);
    const AxisWindow window(field_);
    const std::size_t count = mesh().positions.size();
    anchors_.resize(count);
    influences_.resize(count);
    std::vector<std::uint32_t> region(count, kNoIndex);
    parallel_for(ctx, count, kSkinnedMeshGrain, [&](std::size_t v) {
        const Vec3 p = mesh().positions[v];
        NodeId segment(0);
        const std::uint32_t refined = refined_vertex(static_cast<std::uint32_t>(v));
        if (refined != kNoIndex && refined_region[refined] != kNoIndex) {
            region[v] = refined_region[refined];
            anchors_[v] = build_.anchors[refined];
            segment = window.nearest_adjacent(cage.region_node[region[v]], p);
        } else {
            const CapsuleTree::Nearest nearest = capsules.nearest(Vec3d(p));
            if (nearest.capsule != kNoIndex) {
                const RoundCone& cone = capsules.cone(nearest.capsule);
                segment = capsules.node(nearest.capsule);
                anchors_[v] = Vec3(cone.point(cone.closest_point(Vec3d(p)).t));
            } else {
                anchors_[v] = field_.position(segment);
            }
        }
        influences_[v] = window.at(segment, p);
    });
    free_ = group_by(region, cage.region_node.size());
}

// Finds the connected components of the remeshed faces.
void SkinnedMesh::Body::find_pieces() {
    const auto is_new = [&](std::uint32_t f) {
        return std::ranges::any_of(mesh().quads[f],
                                   [&](std::uint32_t v) { return refined_vertex(v) == kNoIndex; });
    };
    component_.assign(mesh().quads.size(), kNoIndex);
    std::uint32_t count = 0;
    std::vector<std::uint32_t> open;
    for (std::uint32_t first = 0; first < component_.size(); ++first) {
        if (component_[first] != kNoIndex || !is_new(first)) continue;
        component_[first] = count;
        open.push_back(first);
        while (!open.empty()) {
            const std::uint32_t f = open.back();
            open.pop_back();
            for (const std::uint32_t v : mesh().quads[f]) {
                for (const std::uint32_t g : faces_of_[v]) {
                    if (component_[g] != kNoIndex || !is_new(g)) continue;
                    component_[g] = count;
                    open.push_back(g);
                }
            }
        }
        ++count;
    }
    components_ = group_by(component_, count);
}

// Vertices that the projection does not move are projected onto the field in all poses: at rest, and for
// rotations of the whole tree, which change the boxes of the regions.
void SkinnedMesh::Body::find_free(const Context& ctx) {
    if (build_.options.project.method == ProjectionMethod::none || build_.options.fit == Fit::volume) {
        free_ = group_by({}, free_.size());
        return;
    }
    const std::size_t regions = free_.size();
    for (const Rotation& turn : {Rotation{}, rotation_about(normalized(Vec3d{1, 2, 3}), 0.7),
                                 rotation_about(normalized(Vec3d{-3, 1, 2}), 1.9)}) {
        const Vec3d center(field_.bounds().center());
        Pose pose = rest_pose(field_);
        for (Vec3& p : pose.positions) p = Vec3(center + turn(Vec3d(p) - center));
        std::ranges::fill(pose.turns, turn);
        const Skeleton now = posed(field_, pose);
        const MovedPoints carried = carry_to(now, pose.turns, ctx);
        Buffer<Vec3> positions = carried.positions;
        project_onto(now, carried.anchors, positions, ctx);
        std::vector<std::uint32_t> region(positions.size(), kNoIndex);
        for (std::uint32_t r = 0; r < regions; ++r) {
            for (const std::uint32_t v : free_[r]) {
                const float reach = distance(carried.positions[v], carried.anchors[v]);
                if (distance(positions[v], carried.positions[v]) <= kOnField * reach) region[v] = r;
            }
        }
        free_ = group_by(region, regions);
    }
}

SkinnedMesh::Body::MovedPoints SkinnedMesh::Body::carry_to(const Skeleton& now,
                                                           std::span<const Rotation> turns,
                                                           const Context& ctx) const {
    MovedPoints out{Buffer<Vec3>(anchors_.size()), Buffer<Vec3>(anchors_.size()),
                    segment_moves(field_, now, turns)};
    deform_points(influences_, out.moves, anchors_, mesh().positions, out.anchors, out.positions, ctx);
    return out;
}

ProjectReport SkinnedMesh::Body::project_onto(const Skeleton& now, std::span<const Vec3> anchors,
                                              std::span<Vec3> positions, const Context& ctx) const {
    ConvolutionField field(now, build_.field, ctx);
    std::vector<FieldRegion> regions(free_.size());
    parallel_for(ctx, regions.size(), kRegionGrain, [&](std::size_t r) {
        for (const std::uint32_t v : free_[r]) {
            regions[r].box.extend(positions[v]);
            regions[r].box.extend(anchors[v]);
        }
    });
    complete(regions, build_.cage.region_node, now);
    field.set_regions(regions, {build_.tubes, build_.tube, build_.cage.joins}, ctx);
    return project(positions, anchors, free_, FieldRef(field), build_.options.project, ctx);
}

std::vector<FacePair> SkinnedMesh::Body::crossings(std::span<const Vec3> positions, const Skeleton& tubes,
                                                   const Context& ctx) {
    if (build_.options.overlaps == Overlaps::keep) return {};
    moved_.positions.assign(positions.begin(), positions.end());
    if (build_.options.levels == 0 || build_.options.control.base == BaseShape::open)
        return crossing_faces(SurfaceTree(moved_, ctx), kMaxCrossings, ctx).pairs;
    return kept_.crossings(moved_, tubes, kMaxCrossings, ctx).pairs;
}

Skeleton SkinnedMesh::Body::moved_tubes(std::span<const SegmentMove> moves) const {
    const Skeleton& tubes = build_.tubes;
    std::vector<Vec3> places(tubes.size());
    for (const NodeId n : nodes(tubes))
        places[n.index()] = moved(moves[build_.cage.region_node[n.index()].index()], tubes.position(n));
    return {{tubes.parents().begin(), tubes.parents().end()},
            std::move(places),
            {tubes.radii().begin(), tubes.radii().end()},
            tubes.origin()};
}

std::vector<std::uint32_t> SkinnedMesh::Body::at_fault(const SkinnedFrame& frame) const {
    std::vector<std::uint32_t> out;
    const auto add = [&](std::uint32_t face) {
        for (const std::uint32_t v : mesh().quads[face]) {
            for (const std::uint32_t f : faces_of_[v])
                out.insert(out.end(), mesh().quads[f].begin(), mesh().quads[f].end());
        }
    };
    for (const std::uint32_t f : frame.folded) add(f);
    for (const FacePair& p : frame.crossings) {
        add(p.first);
        add(p.second);
    }
    sort_unique(out);
    return out;
}

SkinnedFrame SkinnedMesh::Body::deform(const Pose& pose, std::span<const std::uint32_t> stiff,
                                       const Context& ctx) {
    SkinnedFrame out;
    out.positions = mesh().positions;
    if (pose == rest_pose(rest)) return out;
    const Pose of_field = nodes_.follow(rest, field_, pose);
    const Skeleton now = posed(field_, of_field);
    const MovedPoints carried = carry_to(now, of_field.turns, ctx);
    out.positions = carried.positions;
    if (!free_.items.empty()) out.projected = project_onto(now, carried.anchors, out.positions, ctx);
    parallel_for(ctx, out.positions.size(), kSkinnedMeshGrain, [&](std::size_t v) {
        const Vec3 start = carried.positions[v];
        if (distance(out.positions[v], start) > kLongestWay * distance(start, carried.anchors[v]))
            out.positions[v] = start;
    });
    for (const std::uint32_t v : stiff) out.positions[v] = carried.positions[v];
    std::vector<std::uint32_t> folded = folded_faces(mesh().quads, out.positions, ctx);
    std::ranges::set_difference(folded, rest_folded_, std::back_inserter(out.folded));
    out.folded = smooth_folds(mesh().quads, faces_of_, std::move(out.folded), out.positions);
    std::ranges::set_difference(crossings(out.positions, moved_tubes(carried.moves), ctx), rest_crossings_,
                                std::back_inserter(out.crossings));
    return out;
}

SkinnedMesh::SkinnedMesh(const Skeleton& skeleton, const MeshOptions& options, const Context& ctx)
    : body_(std::make_unique<Body>(skeleton, options, ctx)) {}
SkinnedMesh::~SkinnedMesh() = default;
SkinnedMesh::SkinnedMesh(SkinnedMesh&&) noexcept = default;
SkinnedMesh& SkinnedMesh::operator=(SkinnedMesh&&) noexcept = default;

const MeshResult& SkinnedMesh::made() const { return body_->made; }
const Skeleton& SkinnedMesh::skeleton() const { return body_->rest; }
SkinnedFrame SkinnedMesh::deform(const Pose& pose, std::span<const std::uint32_t> stiff, const Context& ctx) {
    return body_->deform(pose, stiff, ctx);
}
std::vector<std::uint32_t> SkinnedMesh::at_fault(const SkinnedFrame& frame) const {
    return body_->at_fault(frame);
}
void SkinnedMesh::mark_movers(std::uint32_t face, std::span<std::uint8_t> is_mover) const {
    body_->mark_movers(face, is_mover);
}
NodeId SkinnedMesh::mover(std::uint32_t face) const { return body_->mover(face); }

}  // namespace coppice
