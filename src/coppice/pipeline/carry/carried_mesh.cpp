#include "coppice/pipeline/carry/carried_mesh.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/implicit/field_ref.h"
#include "coppice/measure/capsule_tree.h"
#include "coppice/pipeline/carry/faults_internal.h"
#include "coppice/pipeline/carry/node_binding_internal.h"
#include "coppice/pipeline/carry/skin_internal.h"
#include "coppice/pipeline/quads/quad_origin_internal.h"
#include "coppice/pipeline/surface_field_internal.h"
#include "coppice/subdivision/catmull_clark.h"

namespace coppice {

using namespace pipeline_internal;

namespace {

constexpr std::uint32_t kMostCrossings = 1u << 20;
constexpr std::size_t kCarriedMeshGrain = 4096;
constexpr std::size_t kRegionGrain = 64;
constexpr float kLongestWay =
    0.5f;  // onto the field, of the way from the anchor: what is farther is another branch's
constexpr float kOnField = 0.002f;  // of the way from the anchor: a vertex that lay farther off was put there

void check(const MeshOptions& options) {
    if (options.method != MeshMethod::quads)
        throw InvalidInput("animate: method must be quads, whose vertices know the segments that carry them");
    if (options.field.weights != Weights::local)
        throw InvalidInput("animate: weights must be local; global ones are those of one pose");
    if (options.overlaps == Overlaps::apart)
        throw InvalidInput(
            "animate: overlaps must not be apart, which poses know nothing of; bend the trees "
            "apart first, as with: coppice edit TREES apart -o APART.json");
}

// The region of the vertices of a refined cage: that of the cage quad whose vertex each counts as.
std::vector<std::uint32_t> regions_of(const ControlMesh& cage, int levels, const Context& ctx) {
    const PatchRefinement patches(cage.cage.quads, static_cast<std::uint32_t>(cage.cage.positions.size()),
                                  levels, ctx);
    std::vector<std::uint32_t> out;
    for (const std::uint32_t f : patches.owners())
        out.push_back(f == CageTopology::kNone ? kNoRow : cage.region[f]);
    return out;
}

}  // namespace

class CarriedMesh::Body {
  public:
    Body(const Skeleton& skeleton, const MeshOptions& options, const Context& ctx)
        : Body(skeleton, options, QuadOrigin{}, ctx) {}

    CarriedFrame carry(const Pose& pose, std::span<const std::uint32_t> stiff, const Context& ctx);
    std::vector<std::uint32_t> at_fault(const CarriedFrame& frame) const;

    void mark_movers(std::uint32_t face, std::span<std::uint8_t> is_mover) const {
        if (piece_[face] == kNoRow) return mark_movers_of(face, is_mover);
        NodeId last;
        for (const std::uint32_t f : pieces_[piece_[face]]) {
            mark_movers_of(f, is_mover);
            if (last) hold_between(rest, last, mover(f), is_mover);
            last = mover(f);
        }
    }
    NodeId mover(std::uint32_t face) const {
        return nodes_.segment(NodeId(influences_[made.quads().mesh.quads[face][0]].segment[0]));
    }

    Skeleton rest;
    MeshResult made;

  private:
    Body(const Skeleton& skeleton, const MeshOptions& options, QuadOrigin origin, const Context& ctx)
        : rest(skeleton),
          made(mesh_with_origin(skeleton, (check(options), options), origin, ctx)),
          options_(options),
          field_(std::move(origin.field)),
          tubes_(origin.rows.tubes),
          source_(std::move(origin.source)),
          tube_(std::move(origin.tube)),
          nodes_(skeleton, field_, ctx),
          moved_(to_polygons(mesh())),
          faces_of_(compress_rows<std::uint32_t>(mesh().positions.size(),
                                                 [&](const auto& put) {
                                                     for (std::uint32_t f = 0; f < mesh().quads.size(); ++f) {
                                                         for (const std::uint32_t v : mesh().quads[f])
                                                             put(v, f);
                                                     }
                                                 })),
          kept_(std::move(origin.rows), made.quads().cage, mesh()) {
        bind(origin.anchors, ctx);
        find_pieces();
        const Buffer<Vec3>& positions = mesh().positions;
        rest_folded_ = folded_faces(mesh().quads, positions, ctx);
        rest_crossings_ = crossings(positions, tubes_, ctx);
        find_free(ctx);
    }

    void mark_movers_of(std::uint32_t face, std::span<std::uint8_t> is_mover) const {
        for (const std::uint32_t v : mesh().quads[face]) {
            const Influence& by = influences_[v];
            for (std::size_t i = 0; i < by.segment.size() && by.weight[i] > 0; ++i) {
                const NodeId n(by.segment[i]);
                const NodeId from = field_.is_root(n) ? n : field_.parent(n);
                is_mover[nodes_.segment(n).index()] = 1;
                hold_between(rest, nodes_.segment(n), nodes_.segment(from), is_mover);
            }
        }
    }
    const QuadMesh& mesh() const { return made.quads().mesh; }

    void bind(std::span<const Vec3> row_anchors, const Context& ctx);
    struct CarriedPoints {
        Buffer<Vec3> anchors, positions;
        std::vector<SegmentMove> moves;
    };
    /// All points, moved with the segments alone.
    CarriedPoints carry_to(const Skeleton& now, std::span<const Rotation> turns, const Context& ctx) const;
    void find_pieces();
    void find_free(const Context& ctx);
    ProjectReport project_onto(const Skeleton& now, std::span<const Vec3> anchors, std::span<Vec3> positions,
                               const Context& ctx) const;
    std::vector<FacePair> crossings(std::span<const Vec3> positions, Skeleton tubes, const Context& ctx);
    Skeleton moved_tubes(std::span<const SegmentMove> moves) const;

    MeshOptions options_;
    Skeleton field_;                     // that the surface is of, prepared and grafted
    Skeleton tubes_;                     // at rest
    std::vector<NodeId> source_, tube_;  // see QuadOrigin
    NodeBinding nodes_;
    PolygonMesh moved_;  // the faces, for the search of crossings
    CompressedRows<std::uint32_t> faces_of_;
    KeptQuads kept_;
    Buffer<Vec3> anchors_;
    Buffer<Influence> influences_;
    CompressedRows<std::uint32_t> free_;    // by region of the field: vertices that go onto it
    std::vector<std::uint32_t> piece_;      // per face that was remeshed: of those that hang together
    CompressedRows<std::uint32_t> pieces_;  // their faces
    std::vector<std::uint32_t> rest_folded_;
    std::vector<FacePair> rest_crossings_;
};

void CarriedMesh::Body::bind(std::span<const Vec3> row_anchors, const Context& ctx) {
    const ControlMesh& cage = made.quads().cage;
    const std::vector<std::uint32_t> row_region = regions_of(cage, options_.levels, ctx);
    const std::span<const std::uint32_t> row = kept_.old_vertices();
    const CapsuleTree capsules(field_, field_.origin(), ctx);
    const AxisWindow window(field_);
    const std::size_t count = mesh().positions.size();
    anchors_.resize(count);
    influences_.resize(count);
    std::vector<std::uint32_t> region(count, kNoRow);
    parallel_for(ctx, count, kCarriedMeshGrain, [&](std::size_t v) {
        const Vec3 p = mesh().positions[v];
        NodeId segment(0);
        if (row[v] != KeptQuads::kNone && row_region[row[v]] != kNoRow) {
            region[v] = row_region[row[v]];
            anchors_[v] = row_anchors[row[v]];
            segment = window.nearest_beside(cage.region_node[region[v]], p);
        } else {
            const CapsuleTree::Nearest nearest = capsules.nearest(Vec3d(p));
            if (nearest.capsule != CapsuleTree::kNone) {
                const RoundCone& cone = capsules.cone(nearest.capsule);
                segment = capsules.node(nearest.capsule);
                anchors_[v] = Vec3(cone.point(cone.foot(Vec3d(p)).t));
            } else {
                anchors_[v] = field_.position(segment);
            }
        }
        influences_[v] = window.at(segment, p);
    });
    free_ = group_by(region, cage.region_node.size());
}

// Faces that were remeshed, by what of them hangs together.
void CarriedMesh::Body::find_pieces() {
    const std::span<const std::uint32_t> row = kept_.old_vertices();
    const auto is_new = [&](std::uint32_t f) {
        return std::ranges::any_of(mesh().quads[f],
                                   [&](std::uint32_t v) { return row[v] == KeptQuads::kNone; });
    };
    piece_.assign(mesh().quads.size(), kNoRow);
    std::uint32_t count = 0;
    std::vector<std::uint32_t> open;
    for (std::uint32_t first = 0; first < piece_.size(); ++first) {
        if (piece_[first] != kNoRow || !is_new(first)) continue;
        piece_[first] = count;
        open.push_back(first);
        while (!open.empty()) {
            const std::uint32_t f = open.back();
            open.pop_back();
            for (const std::uint32_t v : mesh().quads[f]) {
                for (const std::uint32_t g : faces_of_[v]) {
                    if (piece_[g] != kNoRow || !is_new(g)) continue;
                    piece_[g] = count;
                    open.push_back(g);
                }
            }
        }
        ++count;
    }
    pieces_ = group_by(piece_, count);
}

// Vertices that the projection leaves in place go onto the field in all poses: at rest, and however the whole
// tree is turned, which gives the regions other boxes.
void CarriedMesh::Body::find_free(const Context& ctx) {
    if (options_.project.method == ProjectionMethod::none || options_.fit == Fit::volume) {
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
        const CarriedPoints carried = carry_to(now, pose.turns, ctx);
        Buffer<Vec3> positions = carried.positions;
        project_onto(now, carried.anchors, positions, ctx);
        std::vector<std::uint32_t> region(positions.size(), kNoRow);
        for (std::uint32_t r = 0; r < regions; ++r) {
            for (const std::uint32_t v : free_[r]) {
                const float reach = distance(carried.positions[v], carried.anchors[v]);
                if (distance(positions[v], carried.positions[v]) <= kOnField * reach) region[v] = r;
            }
        }
        free_ = group_by(region, regions);
    }
}

CarriedMesh::Body::CarriedPoints CarriedMesh::Body::carry_to(const Skeleton& now,
                                                             std::span<const Rotation> turns,
                                                             const Context& ctx) const {
    CarriedPoints out{Buffer<Vec3>(anchors_.size()), Buffer<Vec3>(anchors_.size()),
                      segment_moves(field_, now, turns)};
    carry_points(influences_, out.moves, anchors_, mesh().positions, out.anchors, out.positions, ctx);
    return out;
}

ProjectReport CarriedMesh::Body::project_onto(const Skeleton& now, std::span<const Vec3> anchors,
                                              std::span<Vec3> positions, const Context& ctx) const {
    std::optional<GlobalWeights> weights;
    ConvolutionField field = surface_field(now, options_, {}, weights, ctx);
    std::vector<FieldRegion> regions(free_.size());
    parallel_for(ctx, regions.size(), kRegionGrain, [&](std::size_t r) {
        for (const std::uint32_t v : free_[r]) {
            regions[r].box.extend(positions[v]);
            regions[r].box.extend(anchors[v]);
        }
    });
    complete(regions, made.quads().cage.region_node, now);
    field.set_regions(regions, {tubes_, tube_, made.quads().cage.joins}, ctx);
    return project(positions, anchors, free_, FieldRef(field), options_.project, ctx);
}

std::vector<FacePair> CarriedMesh::Body::crossings(std::span<const Vec3> positions, Skeleton tubes,
                                                   const Context& ctx) {
    if (options_.overlaps == Overlaps::keep) return {};
    moved_.positions.assign(positions.begin(), positions.end());
    if (options_.levels == 0 || options_.control.base == BaseShape::open)
        return crossing_faces(SurfaceTree(moved_, ctx), kMostCrossings, ctx).pairs;
    kept_.move_tubes(std::move(tubes));
    return kept_.crossings(moved_, kMostCrossings, ctx).pairs;
}

Skeleton CarriedMesh::Body::moved_tubes(std::span<const SegmentMove> moves) const {
    std::vector<Vec3> places(tubes_.size());
    for (const NodeId n : nodes(tubes_))
        places[n.index()] = moved(moves[source_[n.index()].index()], tubes_.position(n));
    return {{tubes_.parents().begin(), tubes_.parents().end()},
            std::move(places),
            {tubes_.radii().begin(), tubes_.radii().end()},
            tubes_.origin()};
}

std::vector<std::uint32_t> CarriedMesh::Body::at_fault(const CarriedFrame& frame) const {
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

CarriedFrame CarriedMesh::Body::carry(const Pose& pose, std::span<const std::uint32_t> stiff,
                                      const Context& ctx) {
    CarriedFrame out;
    out.positions = mesh().positions;
    if (pose == rest_pose(rest)) return out;
    const Pose of_field = nodes_.follow(rest, field_, pose);
    const Skeleton now = posed(field_, of_field);
    const CarriedPoints carried = carry_to(now, of_field.turns, ctx);
    out.positions = carried.positions;
    if (!free_.items.empty()) out.projected = project_onto(now, carried.anchors, out.positions, ctx);
    parallel_for(ctx, out.positions.size(), kCarriedMeshGrain, [&](std::size_t v) {
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

CarriedMesh::CarriedMesh(const Skeleton& skeleton, const MeshOptions& options, const Context& ctx)
    : body_(std::make_unique<Body>(skeleton, options, ctx)) {}
CarriedMesh::~CarriedMesh() = default;
CarriedMesh::CarriedMesh(CarriedMesh&&) noexcept = default;
CarriedMesh& CarriedMesh::operator=(CarriedMesh&&) noexcept = default;

const MeshResult& CarriedMesh::made() const { return body_->made; }
const Skeleton& CarriedMesh::skeleton() const { return body_->rest; }
CarriedFrame CarriedMesh::carry(const Pose& pose, std::span<const std::uint32_t> stiff, const Context& ctx) {
    return body_->carry(pose, stiff, ctx);
}
std::vector<std::uint32_t> CarriedMesh::at_fault(const CarriedFrame& frame) const {
    return body_->at_fault(frame);
}
void CarriedMesh::mark_movers(std::uint32_t face, std::span<std::uint8_t> is_mover) const {
    body_->mark_movers(face, is_mover);
}
NodeId CarriedMesh::mover(std::uint32_t face) const { return body_->mover(face); }

}  // namespace coppice
