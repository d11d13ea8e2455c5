#include "drag/drag_part.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "coppice/base/box.h"
#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/base/rotation.h"
#include "coppice/field/convolution_field.h"
#include "coppice/pipeline/field_regions_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice::bench {
namespace {

constexpr double kStep = 0.05;            // [rad] angle of rotation covered by one box
constexpr float kCompetitorReach = 1.2f;  // [radii] maximum distance at which branches press on each other,
constexpr float kEmptyReach = 1.6f;       // and at which a tube without a segment connects others

// The range of influence of a segment: a capsule.
struct Capsule {
    Vec3 a, b;
    float radius;
};

std::vector<Capsule> compute_capsules(const QuadBuild& build, const Context& ctx) {
    const ConvolutionField field(build.skeleton, build.field, ctx);
    const float reach = std::max(kCompetitorReach, SegmentBuilder(build.field).reach());
    std::vector<Capsule> out;
    for (const auto& s : field.segments()) {
        const Vec3 start{s.ax, s.ay, s.az}, u{s.ux, s.uy, s.uz};
        const float least = std::min(0.0f, s.begin), most = std::max(s.length, s.end);
        const float radius = std::max({s.radius, s.radius + s.slope * least, s.radius + s.slope * most});
        out.push_back({start + least * u, start + most * u, reach * radius});
    }
    return out;
}

// Boxes around all positions within the branch's influence, on its way from one maximum angle to the other.
class SweptBoxes {
  public:
    SweptBoxes(const QuadBuild& build, const BranchDrag& drag, double largest, const Context& ctx)
        : drag_(drag), capsules_(compute_capsules(build, ctx)), turns_(build.skeleton.size()) {
        for (const std::uint32_t n : drag.nodes()) turns_[n] = 1;
        const int steps = std::max(1, static_cast<int>(std::ceil(2 * largest / kStep)));
        half_ = largest / steps;
        for (int k = 0; k < steps; ++k) middles_.push_back((2 * k + 1 - steps) * half_);
        const auto contents = group_by_tube(build);
        for (std::size_t t = 0; t < contents.size(); ++t) add_tube(contents[t]);
        for (const std::uint32_t t : drag.tube_nodes()) {
            if (contents[t].empty()) add_empty_tube(build.tubes, NodeId(t));
        }
        // A segment without a tube has its own box.
        for (const std::uint32_t n : drag.nodes()) {
            if (!build.tube[n]) add_tube({&n, 1});
        }
    }

    const std::vector<Box3>& boxes() const { return boxes_; }

  private:
    // The segments that each tube wraps.
    static CompressedRows<std::uint32_t> group_by_tube(const QuadBuild& build) {
        return compress_rows<std::uint32_t>(build.tubes.size(), [&](const auto& put) {
            for (std::uint32_t n = 0; n < build.tube.size(); ++n) {
                if (build.tube[n]) put(build.tube[n].index(), n);
            }
        });
    }

    void add_tube(std::span<const std::uint32_t> segments) {
        if (std::ranges::none_of(segments, [&](std::uint32_t n) { return turns_[n] != 0; })) return;
        for (const double middle : middles_) {
            Box3 box;
            for (const std::uint32_t n : segments) box.extend(box_at(n, middle));
            // The search range of a tube of several segments is the ball around them.
            if (segments.size() > 1) {
                const Vec3 center = box.center();
                box = capsule_box(center, center, 0.5f * box.diagonal());
            }
            boxes_.push_back(box);
        }
    }

    // The search range of a tube without segments is the ball around its own line, of which either end may be
    // at rest.
    void add_empty_tube(const Skeleton& tubes, NodeId t) {
        const Vec3 end = tubes.position(t), start = tubes.is_root(t) ? end : tubes.position(tubes.parent(t));
        const Capsule line{start, end, kEmptyReach * tubes.radius(t)};
        for (const double middle : middles_) {
            Box3 box = turned(line, middle);
            box.extend(capsule_box(start, end, line.radius));
            const Vec3 center = box.center();
            boxes_.push_back(capsule_box(center, center, 0.5f * box.diagonal()));
        }
    }

    Box3 box_at(std::uint32_t n, double angle) const {
        const Capsule& c = capsules_[n];
        return turns_[n] != 0 ? turned(c, angle) : capsule_box(c.a, c.b, c.radius);
    }

    Box3 turned(const Capsule& c, double angle) const {
        const Rotation turn = rotation_about(drag_.axis(), angle);
        const Vec3d a = Vec3d(c.a) - drag_.pivot(), b = Vec3d(c.b) - drag_.pivot();
        const double way = half_ * std::max(length(a), length(b));  // maximum to either end of the step
        return capsule_box(Vec3(drag_.pivot() + turn(a)), Vec3(drag_.pivot() + turn(b)),
                           1.001f * (c.radius + static_cast<float>(way)));
    }

    const BranchDrag& drag_;
    std::vector<Capsule> capsules_;  // by node
    std::vector<std::uint8_t> turns_;
    double half_ = 0;
    std::vector<double> middles_;
    std::vector<Box3> boxes_;
};

using Flags = std::vector<std::uint8_t>;

// Returns per region whether a vertex of one of its quads is flagged.
Flags regions_of_vertices(const ControlMesh& control, const Flags& vertices) {
    Flags out(control.region_node.size());
    for (std::size_t f = 0; f < control.region.size(); ++f) {
        for (const std::uint32_t v : control.cage.quads[f]) out[control.region[f]] |= vertices[v];
    }
    return out;
}

// Returns per vertex whether it has a quad of a flagged region.
Flags vertices_of_regions(const ControlMesh& control, const Flags& regions) {
    Flags out(control.cage.positions.size());
    for (std::size_t f = 0; f < control.region.size(); ++f) {
        if (regions[control.region[f]] == 0) continue;
        for (const std::uint32_t v : control.cage.quads[f]) out[v] = 1;
    }
    return out;
}

// Returns the regions of all quads with refined vertices that depend on a rotating vertex: its adjacent
// quads, and their neighbours.
Flags turning_regions(const ControlMesh& control, std::span<const std::uint32_t> turning) {
    Flags turns(control.cage.positions.size());
    for (const std::uint32_t v : turning) turns[v] = 1;
    Flags follows(turns.size());
    for (const Quad& q : control.cage.quads) {
        if (std::ranges::none_of(q, [&](std::uint32_t v) { return turns[v] != 0; })) continue;
        for (const std::uint32_t v : q) follows[v] = 1;
    }
    return regions_of_vertices(control, follows);
}

Flags changed_regions(const QuadBuild& build, const BranchDrag& drag, double largest, const Context& ctx) {
    const ControlMesh& control = build.cage;
    if (build.options.project.relax_passes > 0) return Flags(control.region_node.size(), 1);
    Flags out = turning_regions(control, drag.cage_vertices());
    const SweptBoxes swept(build, drag, largest, ctx);
    if (swept.boxes().empty()) return out;
    const BoxTree tree(swept.boxes(), ctx);
    const auto regions = pipeline_internal::field_regions(control, build.skeleton);
    for (std::size_t r = 0; r < out.size(); ++r) {
        if (out[r] == 0 && !regions[r].box.empty() && tree.meets(regions[r].box)) out[r] = 1;
    }
    return out;
}

// The cage of a part, with quads of all flagged regions.
struct PartCage {
    std::vector<std::uint32_t> vertex, quad, region, clip, clip_quad;
    Buffer<Quad> quads;
};

PartCage part_cage(const ControlMesh& control, const Flags& regions) {
    PartCage out;
    const Flags has = vertices_of_regions(control, regions);
    std::vector<std::uint32_t> own(has.size(), kNoIndex);
    for (std::uint32_t v = 0; v < has.size(); ++v) {
        if (has[v] == 0) continue;
        own[v] = static_cast<std::uint32_t>(out.vertex.size());
        out.vertex.push_back(v);
    }
    std::size_t next_clip = 0;
    for (std::uint32_t f = 0; f < control.region.size(); ++f) {
        // A flat end belongs to one region: it is included as a whole or not at all.
        const bool clips = next_clip < control.clip.size() && control.clip[next_clip].first_quad == f;
        const auto clip = static_cast<std::uint32_t>(clips ? next_clip++ : 0);
        if (regions[control.region[f]] == 0) continue;
        if (clips) {
            out.clip.push_back(clip);
            out.clip_quad.push_back(static_cast<std::uint32_t>(out.quad.size()));
        }
        Quad q = control.cage.quads[f];
        for (std::uint32_t& v : q) v = own[v];
        out.quads.push_back(q);
        out.quad.push_back(f);
        out.region.push_back(control.region[f]);
    }
    return out;
}

// Calls visit(quad of the part, that of the whole) for all refined quads of the part.
template <class Visit>
void visit_refined(const DragPart& part, const Visit& visit) {
    const std::uint32_t each = 1u << (2 * part.patches.levels());
    for (std::uint32_t f = 0; f < part.cage_quad.size(); ++f) {
        for (std::uint32_t k = 0; k < each; ++k) visit(f * each + k, part.cage_quad[f] * each + k);
    }
}

// Numbers the drawn vertices: first those that are written, then those that are only shaded again, then all
// others.
void number_vertices(const QuadBuild& build, const Flags& changed, DragPart& part, const Context& ctx) {
    const Buffer<Quad> own = part.patches.quads(ctx);
    const Buffer<Quad> all = build.refinement.quads(ctx);
    std::vector<std::uint32_t> from(build.refined.size(), kNoIndex), drawn(from.size(), kNoIndex);
    const std::uint32_t each = 1u << (2 * part.patches.levels());
    visit_refined(part, [&](std::uint32_t q, std::uint32_t of_model) {
        if (changed[part.region[q / each]] == 0) return;
        for (std::size_t k = 0; k < 4; ++k) from[all[of_model][k]] = own[q][k];
    });
    const auto take = [&](std::uint32_t v) {
        drawn[v] = static_cast<std::uint32_t>(part.vertex.size());
        part.vertex.push_back(v);
    };
    for (std::uint32_t v = 0; v < from.size(); ++v) {
        if (from[v] != kNoIndex) take(v);
    }
    part.written = static_cast<std::uint32_t>(part.vertex.size());
    for (const std::uint32_t v : part.vertex) part.from.push_back(from[v]);
    for (const Quad& q : all) {
        if (std::ranges::none_of(q, [&](std::uint32_t v) { return from[v] != kNoIndex; })) continue;
        for (const std::uint32_t v : q) {
            if (drawn[v] == kNoIndex) take(v);
        }
    }
    part.shaded = static_cast<std::uint32_t>(part.vertex.size());
    for (std::uint32_t v = 0; v < drawn.size(); ++v) {
        if (drawn[v] == kNoIndex) take(v);
    }
    part.quads.resize(all.size());
    for (std::size_t f = 0; f < all.size(); ++f) {
        for (std::size_t k = 0; k < 4; ++k) part.quads[f][k] = drawn[all[f][k]];
    }
    part.fans = compress_rows<std::uint32_t>(part.shaded, [&](const auto& put) {
        for (std::uint32_t f = 0; f < part.quads.size(); ++f) {
            for (const std::uint32_t v : part.quads[f]) {
                if (v < part.shaded) put(v, f);
            }
        }
    });
}

DragPart part_of_regions(const QuadBuild& build, const Flags& changed, const Context& ctx) {
    const ControlMesh& control = build.cage;
    PartCage cage = part_cage(control, regions_of_vertices(control, vertices_of_regions(control, changed)));
    PatchRefinement patches(cage.quads, static_cast<std::uint32_t>(cage.vertex.size()), build.options.levels,
                            ctx);
    DragPart part{.cage_vertex = std::move(cage.vertex),
                  .cage_quad = std::move(cage.quad),
                  .region = std::move(cage.region),
                  .clip = std::move(cage.clip),
                  .clip_quad = std::move(cage.clip_quad),
                  .patches = std::move(patches)};
    number_vertices(build, changed, part, ctx);
    return part;
}

}  // namespace

ControlMesh make_control(const QuadBuild& build, const DragPart& part) {
    const ControlMesh& all = build.cage;
    const auto quads = part.patches.cage().quads;
    ControlMesh out{.cage = {{}, {quads.begin(), quads.end()}, all.cage.origin},
                    .region = part.region,
                    .region_node = all.region_node,
                    .clip = select_clip_planes(part, all.clip)};
    for (const std::uint32_t v : part.cage_vertex) {
        out.cage.positions.push_back(all.cage.positions[v]);
        out.anchors.push_back(all.anchors[v]);
    }
    for (const std::uint32_t f : part.cage_quad) out.part.push_back(all.part[f]);
    return out;
}

std::vector<ClipPlane> select_clip_planes(const DragPart& part, std::span<const ClipPlane> clips) {
    std::vector<ClipPlane> out;
    for (std::size_t k = 0; k < part.clip.size(); ++k) {
        out.push_back(clips[part.clip[k]]);
        out.back().first_quad = part.clip_quad[k];
    }
    return out;
}

DragPart drag_part(const QuadBuild& build, const BranchDrag& drag, double max_angle, const Context& ctx) {
    return part_of_regions(build, changed_regions(build, drag, std::fabs(max_angle), ctx), ctx);
}

DragPart whole_part(const QuadBuild& build, const Context& ctx) {
    return part_of_regions(build, Flags(build.cage.region_node.size(), 1), ctx);
}

}  // namespace coppice::bench
