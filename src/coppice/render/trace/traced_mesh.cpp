#include "coppice/render/trace/traced_mesh_internal.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/parallel.h"
#include "coppice/render/trace/mip_map_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kGrain = 65536;

/// Adds the values of the corners of a face, divided in the same way as by `set_faces`.
template <class T>
void add_corners(std::span<const T> t, std::vector<std::array<T, 4>>& out) {
    if (t.size() == 4) out.push_back({t[0], t[1], t[2], t[3]});
    for (std::size_t k = 1; t.size() != 4 && k + 1 < t.size(); ++k)
        out.push_back({t[0], t[k], t[k + 1], t[k + 1]});
}

/// Lets rays pass through holes.
void skip_holes(const RTCFilterFunctionNArguments* args) {
    const auto& mesh = *static_cast<const TracedMesh*>(args->geometryUserPtr);
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] == 0) continue;
        const FacePlace place{RTCHitN_primID(args->hit, args->N, i), RTCHitN_u(args->hit, args->N, i),
                              RTCHitN_v(args->hit, args->N, i)};
        if (mesh.is_hole(place)) args->valid[i] = 0;
    }
}

}  // namespace

void TracedMesh::set_faces(const PolygonMesh& mesh, std::vector<Vec3> positions) {
    positions_ = std::move(positions);
    quads_.reserve(mesh.face_count());
    edges_.reserve(mesh.face_count());
    first_quad_.reserve(mesh.face_count() + 1);
    first_quad_.push_back(0);
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const auto c = mesh.face(f);
        if (c.size() == 4) {
            quads_.push_back({c[0], c[1], c[2], c[3]});
            edges_.push_back(0b1111);
        }
        for (std::size_t k = 1; c.size() != 4 && k + 1 < c.size(); ++k) {
            quads_.push_back({c[0], c[k], c[k + 1], c[k + 1]});
            edges_.push_back(
                static_cast<std::uint8_t>((k == 1 ? 1 : 0) | 0b10 | (k + 2 == c.size() ? 0b1000 : 0)));
        }
        first_quad_.push_back(static_cast<std::uint32_t>(quads_.size()));
    }
}

void TracedMesh::set_texture(const PolygonMesh& mesh, std::span<const std::uint32_t> face_materials,
                             std::span<const RenderMaterial> materials) {
    materials_ = materials;
    texture_.reserve(quads_.size());
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const std::size_t first = mesh.first[f], count = mesh.first[f + 1] - first;
        add_corners(std::span(mesh.texture).subspan(first, count), texture_);
        if (!mesh.texture_blends.empty())
            add_corners(std::span(mesh.texture_blends).subspan(first, count), texture_blends_);
        if (!face_materials.empty()) quad_materials_.resize(texture_.size(), face_materials[f]);
    }
}

void TracedMesh::smooth_normals() {
    normals_.assign(positions_.size(), Vec3{});
    for (const Quad& q : quads_) {
        const Vec3 n = cross(positions_[q[2]] - positions_[q[0]], positions_[q[3]] - positions_[q[1]]);
        for (std::size_t k = 0; k < (q[2] == q[3] ? 3u : 4u); ++k) normals_[q[k]] += n;
    }
    for (Vec3& n : normals_) n = normalized(n, Vec3{});
}

EmbreeGeometry TracedMesh::make_geometry(RTCDevice device, std::span<const Quad> faces,
                                         const Context& ctx) const {
    EmbreeGeometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD));
    const auto positions =
        new_embree_buffer<Vec3>(geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, positions_.size());
    const auto quads =
        new_embree_buffer<Quad>(geometry.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT4, faces.size());
    parallel_for(ctx, positions.size(), kGrain, [&](std::size_t i) { positions[i] = positions_[i]; });
    parallel_for(ctx, quads.size(), kGrain, [&](std::size_t i) { quads[i] = faces[i]; });
    const bool has_holes = std::ranges::any_of(materials_, &RenderMaterial::cut_out);
    if (has_holes && faces.data() == quads_.data()) {
        rtcSetGeometryUserData(geometry.get(), const_cast<TracedMesh*>(this));
        rtcSetGeometryIntersectFilterFunction(geometry.get(), skip_holes);
        rtcSetGeometryOccludedFilterFunction(geometry.get(), skip_holes);
    }
    return geometry;
}

CornerWeights TracedMesh::weights_at(const FacePlace& place) const {
    const Quad& q = quads_[place.face];
    const float u = place.u, v = place.v;
    if (u + v <= 1) return {{0, 1, 3}, {q[0], q[1], q[3]}, {1 - u - v, u, v}};
    return {{2, 3, 1}, {q[2], q[3], q[1]}, {u + v - 1, 1 - u, 1 - v}};
}

Vec3 TracedMesh::lifted(const FacePlace& place, Vec3 position, float side) const {
    const auto [corner, vertex, weight] = weights_at(place);
    Vec3 p = position;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 normal = normals_[vertex[k]] * side;
        p += normal * (weight[k] * std::max(0.0f, dot(positions_[vertex[k]] - position, normal)));
    }
    return p;
}

std::optional<TexturePlaces> TracedMesh::texture_places(const FacePlace& place) const {
    if (texture_.empty()) return std::nullopt;
    TexturePlaces out{texture_place(place, texture_[place.face]), {}, 0, material(place.face)};
    if (texture_blends_.empty()) return out;
    const auto& blends = texture_blends_[place.face];
    const auto [corner, vertex, weight] = weights_at(place);
    for (std::size_t k = 0; k < 3; ++k) out.weight += blends[corner[k]].weight * weight[k];
    if (!(out.weight > 0)) return out;
    out.second =
        texture_place(place, {blends[0].second, blends[1].second, blends[2].second, blends[3].second});
    return out;
}

TexturePlace TracedMesh::texture_place(const FacePlace& place, const std::array<TexturePoint, 4>& t) const {
    const auto [corner, vertex, weight] = weights_at(place);
    const TexturePoint a = t[corner[0]], b = t[corner[1]], c = t[corner[2]];
    TexturePlace out{a.u * weight[0] + b.u * weight[1] + c.u * weight[2],
                     a.v * weight[0] + b.v * weight[1] + c.v * weight[2],
                     {},
                     {}};
    const Vec3 to_b = positions_[vertex[1]] - positions_[vertex[0]];
    const Vec3 to_c = positions_[vertex[2]] - positions_[vertex[0]];
    const Vec3 across = cross(to_b, to_c);
    const float square = dot(across, across);
    if (!(square > 0)) return out;
    // Gradients of the weights of b and c.
    const Vec3 of_b = cross(to_c, across) / square, of_c = cross(across, to_b) / square;
    out.gradient_u = of_b * (b.u - a.u) + of_c * (c.u - a.u);
    out.gradient_v = of_b * (b.v - a.v) + of_c * (c.v - a.v);
    return out;
}

bool TracedMesh::is_hole(const FacePlace& place) const {
    const std::uint32_t m = material(place.face);
    if (m >= materials_.size() || !materials_[m].cut_out) return false;
    const auto [corner, vertex, weight] = weights_at(place);
    const auto& t = texture_[place.face];
    TexturePoint at;
    for (std::size_t k = 0; k < 3; ++k) {
        at.u += t[corner[k]].u * weight[k];
        at.v += t[corner[k]].v * weight[k];
    }
    return is_cut_out(materials_[m].color, at);
}

}  // namespace coppice
