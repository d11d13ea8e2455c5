#include "coppice/pipeline/texture/bark_texture_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "coppice/base/parallel.h"
#include "coppice/pipeline/texture/radii_beyond_internal.h"
#include "coppice/pipeline/texture/texture_quality_internal.h"
#include "coppice/pipeline/texture/texture_transfer_internal.h"
#include "coppice/pipeline/texture/tube_texture_internal.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::size_t kFaceGrain = 1024;

// Moves coordinates around a branch by whole turns, so that those of a face are within half a turn of the
// first one, and their mean is in [0, 1).
void join_turns(std::span<BarkPoint> corners) {
    float mean = 0;
    for (BarkPoint& c : corners) {
        c.turns -= std::round(c.turns - corners[0].turns);
        mean += c.turns / static_cast<float>(corners.size());
    }
    for (BarkPoint& c : corners) c.turns -= std::floor(mean);
}

TexturePoint to_texture(const BarkPoint& p, std::uint32_t wraps) {
    return {p.turns * static_cast<float>(wraps), p.v};
}

// Sets the coordinates of a face to those of its projection on its own plane, with the direction and the
// position in the texture of a point.
void project_face(std::span<const Vec3> face, Vec3 point, const BarkPoint& at, std::span<TexturePoint> out) {
    const Vec3 normal = face.size() == 4 ? cross(face[2] - face[0], face[3] - face[1])
                                         : cross(face[1] - face[0], face[2] - face[0]);
    project_on_plane(face, {point, normal, at.along}, at.tiles_per_metre, out);
    for (TexturePoint& t : out) {
        t.u += at.turns * static_cast<float>(at.wraps);
        t.v += at.v;
    }
}

// The coordinates of the corners of faces, the zone of each face for its second set, and its radius.
struct FaceTexture {
    FaceTexture(std::size_t faces, std::size_t corners, bool has_radii)
        : points(corners), zones(faces, kNoIndex), radii(has_radii ? faces : 0, kOpen) {}

    // Sets the radius of a face to the mean at some places, if it is requested and not known yet.
    void set_radius(std::size_t face, std::span<const BarkPoint> places, const RadiiBeyond& beyond) {
        if (radii.empty() || radii[face] != kOpen) return;
        float sum = 0;
        for (const BarkPoint& p : places) sum += beyond.at(p.tube, p.share);
        radii[face] = sum / static_cast<float>(places.size());
    }

    static constexpr float kOpen = -1;

    Buffer<TexturePoint> points;
    std::vector<std::uint32_t> zones;
    std::vector<float> radii;  // [m] as in BarkTexture; kOpen: not known yet
};

// Returns the second set of the corners of faces, N each.
template <std::size_t N>
Buffer<TextureBlend> make_blends(const TubeTexture& tubes, const FaceTexture& faces, const Context& ctx) {
    Buffer<TextureBlend> out(faces.points.size());
    parallel_for(ctx, out.size(), kFaceGrain,
                 [&](std::size_t i) { out[i] = tubes.blend(faces.zones[i / N], faces.points[i]); });
    return out;
}

// Finds coordinates for faces without a rectangle of a tube, by those of the closest tube.
class FaceTransfer {
  public:
    FaceTransfer(std::span<const Vec3> positions, const TextureTransfer& transfer, const RadiiBeyond& beyond,
                 const Context& ctx)
        : positions_(positions),
          transfer_(transfer),
          beyond_(beyond),
          ctx_(ctx),
          number_(positions.size(), kNoIndex) {}

    // Finds the points of the vertices that are marked.
    void find_vertices(std::span<const std::uint8_t> wanted) {
        std::vector<std::uint32_t> vertices;
        for (std::uint32_t v = 0; v < positions_.size(); ++v) {
            if (wanted[v] == 0) continue;
            number_[v] = static_cast<std::uint32_t>(vertices.size());
            vertices.push_back(v);
        }
        found_.resize(vertices.size());
        if (transfer_.empty()) return;
        parallel_for_ranges(ctx_, vertices.size(), kFaceGrain, [&](IndexRange range) {
            std::uint32_t nearest = kNoIndex;  // of the last vertex, which is often close to the next
            for (std::size_t i = range.begin; i < range.end; ++i) {
                const Vec3 p = positions_[vertices[i]];
                nearest = transfer_.find_nearest(Vec3d(p), nearest);
                found_[i] = {nearest, transfer_.evaluate(nearest, p)};
            }
        });
    }

    // Sets the coordinates of a face, and its zone. Returns false if they would be projected on a plane.
    template <std::size_t N>
    bool set(const std::array<std::uint32_t, N>& face, std::size_t index, FaceTexture& texture) const {
        const auto out = std::span(texture.points).subspan(N * index, N);
        std::array<BarkPoint, N> corners;
        for (std::size_t k = 0; k < N; ++k) corners[k] = found_[number_[face[k]]].point;
        const BarkPoint& first = corners[0];
        BarkPoint own = first;
        Vec3 center = positions_[face[0]];  // at which `own` is
        if (std::ranges::any_of(corners, [&](const BarkPoint& c) { return c.axis != first.axis; })) {
            center = {};
            for (const std::uint32_t v : face) center += positions_[v] * (1.0f / N);
            // The quads found before are close, and bound the searches.
            const std::uint32_t nearest =
                transfer_.find_nearest(Vec3d(center), found_[number_[face[0]]].nearest);
            own = transfer_.evaluate(nearest, center);
            for (std::size_t k = 0; k < N; ++k) {
                if (corners[k].axis == own.axis) continue;
                const Vec3 p = positions_[face[k]];
                corners[k] = transfer_.evaluate(transfer_.find_nearest(Vec3d(p), nearest, own.axis), p);
            }
        }
        if (own.axis != kNoIndex) {
            join_turns(corners);
            for (std::size_t k = 0; k < N; ++k) out[k] = to_texture(corners[k], own.wraps);
            texture.set_radius(index, corners, beyond_);
            texture.zones[index] = own.zone;
            if (is_good_texture(face_positions(face, positions_), out, own.tiles_per_metre)) return true;
        }
        texture.zones[index] = kNoIndex;
        project_face(face_positions(face, positions_), center, own, out);
        return false;
    }

  private:
    // The closest quad to a vertex, and its point there.
    struct Found {
        std::uint32_t nearest = kNoIndex;
        BarkPoint point;
    };

    std::span<const Vec3> positions_;
    const TextureTransfer& transfer_;
    const RadiiBeyond& beyond_;
    const Context& ctx_;
    std::vector<std::uint32_t> number_;  // per vertex: its place in `found_`
    std::vector<Found> found_;
};

// Sets the faces that are marked, and counts them.
template <std::size_t N>
void transfer_faces(std::span<const std::array<std::uint32_t, N>> faces, std::span<const Vec3> positions,
                    std::span<const std::uint8_t> wanted, const TextureTransfer& carrier,
                    const RadiiBeyond& beyond, FaceTexture& out, TextureReport& report, const Context& ctx) {
    std::vector<std::uint8_t> vertices(positions.size(), 0), is_projected(faces.size(), 0);
    for (std::size_t i = 0; i < faces.size(); ++i) {
        if (wanted[i] == 0) continue;
        ++report.transferred;
        for (const std::uint32_t v : faces[i]) vertices[v] = 1;
    }
    FaceTransfer transfer(positions, carrier, beyond, ctx);
    transfer.find_vertices(vertices);
    parallel_for(ctx, faces.size(), kFaceGrain, [&](std::size_t i) {
        if (wanted[i] != 0) is_projected[i] = transfer.set(faces[i], i, out) ? 0 : 1;
    });
    report.projected = static_cast<std::uint64_t>(std::ranges::count(is_projected, 1));
}

// Texture of the faces of a surface that were made from the refined quads of tubes.
class QuadTexture {
  public:
    QuadTexture(const QuadMesh& mesh, const QuadBuild& build, const TextureOptions& options,
                const SlotOptions& slots, const Context& ctx)
        : mesh_(mesh),
          build_(build),
          ctx_(ctx),
          tubes_(build, options, slots, ctx),
          beyond_(build),
          options_(options),
          slots_(slots),
          texture_(mesh.quads.size(), 4 * mesh.quads.size(), slots.twigs),
          is_open_(mesh.quads.size(), 1) {}

    BarkTexture run() {
        if (build_.coarse.quads.empty()) {
            set_refined();
        } else {
            set_coarse();
        }
        BarkTexture out;
        Texture& texture = out.texture;
        transfer(texture.report);
        if (options_.blend) texture.blends = make_blends<4>(tubes_, texture_, ctx_);
        texture.points = std::move(texture_.points);
        out.radii = std::move(texture_.radii);
        texture.report.axes = tubes_.axis_count();
        measure_texture(mesh_.quads, mesh_.positions, texture.points, {options_.tile, slots_, out.radii},
                        texture.report, ctx_);
        return out;
    }

  private:
    int levels() const { return build_.refinement.levels(); }
    std::span<TexturePoint> corners(std::size_t face) {
        return std::span(texture_.points).subspan(4 * face, 4);
    }

    void set_refined() {
        const std::vector<std::uint32_t> kept = find_kept_quads(build_, tubes_.tube_rows());
        parallel_for_ranges(ctx_, kept.size(), kFaceGrain, [&](IndexRange range) {
            const std::uint32_t mask = tubes_.size() - 1;
            PatchColumns columns;
            std::uint32_t current = kNoIndex;  // cage quad of the columns
            for (std::size_t i = range.begin; i < range.end; ++i) {
                const std::uint32_t f = kept[i] >> (2 * levels());
                const TexturePatch& patch = tubes_.patch(f);
                if (!patch.is_rectangle()) {
                    set_cap(i, f);
                    continue;
                }
                if (f != current) tubes_.set_columns(patch, columns);
                current = f;
                set_quad(i, patch, columns, (kept[i] >> levels()) & mask, kept[i] & mask);
            }
        });
    }

    void set_quad(std::size_t face, const TexturePatch& patch, const PatchColumns& columns, std::uint32_t row,
                  std::uint32_t column) {
        const std::span<TexturePoint> out = corners(face);
        for (std::uint32_t k = 0; k < 4; ++k) {
            const std::uint32_t at = column + (k == 1 || k == 2 ? 1 : 0), up = row + k / 2;
            out[k] = {columns.u[at], tubes_.v(patch, columns, at, up)};
        }
        texture_.zones[face] = patch.zone;
        const BarkPoint middle{.tube = patch.tube,
                               .share = tubes_.share(patch, static_cast<float>(row) + 0.5f)};
        texture_.set_radius(face, {&middle, 1}, beyond_);
        is_open_[face] = texture_area(out) > 0 ? 0 : 1;  // rows may have no length
    }

    // The corners of coarse quads are refined vertices of the sides of a tube, or of another cage quad.
    void set_coarse() {
        const auto& coarse = build_.coarse;
        std::vector<BarkPoint> at(build_.refinement.vertex_count());
        std::uint32_t first = kNoIndex;  // cage quad of the current group
        for (std::size_t i = 0; i < coarse.quads.size(); ++i) {
            const std::uint32_t f = coarse.cage_quad[i];
            const CageRun group = find_group(f);
            if (group.first != first) set_vertices(group, at);
            first = group.first;
            const TexturePatch& patch = tubes_.patch(f);
            if (!patch.is_rectangle()) {
                set_cap(i, f);
                continue;
            }
            std::array<BarkPoint, 4> corner;
            std::ranges::transform(coarse.quads[i], corner.begin(), [&](std::uint32_t v) { return at[v]; });
            join_turns(corner);
            for (std::size_t k = 0; k < 4; ++k) corners(i)[k] = to_texture(corner[k], patch.wraps);
            texture_.zones[i] = patch.zone;
            texture_.set_radius(i, corner, beyond_);
            is_open_[i] = texture_area(corners(i)) > 0 ? 0 : 1;
        }
    }

    // Returns the cage quads with which one forms a grid.
    CageRun find_group(std::uint32_t f) const {
        if (build_.cage.part[f] != TubeFace::side) return {f, 1};
        return tubes_.faces()[build_.cage.region[f]].side;
    }

    void set_vertices(const CageRun& group, std::vector<BarkPoint>& at) const {
        for (std::uint32_t f = group.first; f < group.first + group.count; ++f) {
            const TexturePatch& p = tubes_.patch(f);
            if (!p.is_rectangle()) continue;
            for (std::uint32_t row = 0; row <= tubes_.size(); ++row) {
                for (std::uint32_t column = 0; column <= tubes_.size(); ++column)
                    at[tubes_.vertex(f, column, row)] = {.turns = tubes_.turns(p, column),
                                                         .v = tubes_.v(p, column, row),
                                                         .tube = p.tube,
                                                         .share = tubes_.share(p, static_cast<float>(row))};
            }
        }
    }

    // Projects a quad of the cap of a tube on the plane across its end; other quads stay open.
    void set_cap(std::size_t face, std::uint32_t f) {
        const TubeFace part = build_.cage.part[f];
        const NodeId tube(build_.cage.region[f]);
        const BarkPoint place{.tube = tube, .share = part == TubeFace::start ? 0.0f : 1.0f};
        texture_.set_radius(face, {&place, 1}, beyond_);
        if (part != TubeFace::start && part != TubeFace::end) return;
        const CageRun side = tubes_.faces()[tube.index()].side;
        const Skeleton& s = build_.tubes;
        Vec3 normal, center;
        float density = 1 / options_.tile;
        if (side.count > 0) {
            const NodeId end = part == TubeFace::start ? s.parent(tube) : tube;
            center = s.position(end);
            normal = s.position(tube) - s.position(s.parent(tube));
            if (part == TubeFace::start) normal = -normal;
            density = tubes_.patch(side.first).tiles_per_metre;
        } else {  // a side of a ball
            center = s.position(tube);
            for (const std::uint32_t v : build_.cage.cage.quads[f])
                normal += build_.cage.cage.positions[v] - center;
        }
        project_on_plane(face_positions(mesh_.quads[face], mesh_.positions),
                         {center, normal, perpendicular(normalized(normal))}, density, corners(face));
        is_open_[face] = texture_area(corners(face)) > 0 ? 0 : 1;  // quads may be turned over against the end
    }

    // Sets the quads that replaced tubes, and those of irregular forks.
    void transfer(TextureReport& report) {
        if (std::ranges::find(is_open_, 1) == is_open_.end()) return;
        const TextureTransfer carrier(build_, tubes_, tubes_near_open(), ctx_);
        transfer_faces<4>(mesh_.quads, mesh_.positions, is_open_, carrier, beyond_, texture_, report, ctx_);
    }

    // Returns per tube whether open faces may be near it.
    std::vector<std::uint8_t> tubes_near_open() const {
        const TubeRows& rows = tubes_.tube_rows();
        std::vector<std::uint8_t> out(build_.tubes.size(), 0);
        for (TubeRow s = 0; s < rows.count(); ++s) {
            if (!build_.remeshed.stays(s)) out[rows.tube(s).index()] = 1;
        }
        for (const RemeshTrace::RepairPatch& patch : build_.remeshed.repair_patches) {
            for (const TubeRow s : patch.adjacent) out[rows.tube(s).index()] = 1;
        }
        for (std::uint32_t f = 0; f < build_.cage.part.size(); ++f) {
            if (build_.cage.part[f] != TubeFace::fork || tubes_.patch(f).is_rectangle()) continue;
            rows.for_each_tube_at(NodeId(build_.cage.region[f]), [&](NodeId tube) { out[tube.index()] = 1; });
        }
        return out;
    }

    const QuadMesh& mesh_;
    const QuadBuild& build_;
    const Context& ctx_;
    TubeTexture tubes_;
    RadiiBeyond beyond_;
    TextureOptions options_;
    SlotOptions slots_;
    FaceTexture texture_;
    std::vector<std::uint8_t> is_open_;  // per face: whether it has no coordinates yet
};

}  // namespace

BarkTexture bark_texture(const QuadMesh& mesh, const QuadBuild& build, const TextureOptions& options,
                         const SlotOptions& slots, const Context& ctx) {
    return QuadTexture(mesh, build, options, slots, ctx).run();
}

BarkTexture bark_texture(const TriMesh& mesh, const QuadBuild& build, const TextureOptions& options,
                         const SlotOptions& slots, const Context& ctx) {
    const TubeTexture tubes(build, options, slots, ctx);
    const TextureTransfer carrier(build, tubes, std::vector<std::uint8_t>(build.tubes.size(), 1), ctx);
    const std::vector<std::uint8_t> all(mesh.triangles.size(), 1);
    FaceTexture faces(mesh.triangles.size(), 3 * mesh.triangles.size(), slots.twigs);
    BarkTexture out;
    Texture& texture = out.texture;
    transfer_faces<3>(mesh.triangles, mesh.positions, all, carrier, RadiiBeyond(build), faces, texture.report,
                      ctx);
    if (options.blend) texture.blends = make_blends<3>(tubes, faces, ctx);
    texture.points = std::move(faces.points);
    out.radii = std::move(faces.radii);
    texture.report.axes = tubes.axis_count();
    measure_texture(mesh.triangles, mesh.positions, texture.points, {options.tile, slots, out.radii},
                    texture.report, ctx);
    return out;
}

}  // namespace coppice::pipeline_internal
