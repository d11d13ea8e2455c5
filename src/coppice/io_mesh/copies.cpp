#include "coppice/io_mesh/copies_internal.h"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <string>

#include "coppice/base/error.h"
#include "coppice/base/srgb.h"
#include "coppice/io_mesh/glb_parts_internal.h"

namespace coppice::io_internal {
namespace {

std::array<float, 256> make_decoded() {
    std::array<float, 256> out{};
    for (std::size_t byte = 0; byte < out.size(); ++byte)
        out[byte] = decode_srgb(static_cast<float>(byte) / 255);
    return out;
}

void check_name(const std::string& name, std::set<std::string>& names, std::string_view kind) {
    if (make_material_name(name) != name)
        throw InvalidInput(
            fmt::format("the name '{}' of a {} must consist of letters, digits and underscores", name, kind));
    if (!names.insert(name).second) throw InvalidInput(fmt::format("two {}s have the name '{}'", kind, name));
}

/// Returns a view of a prototype with its texture.
MeshView make_view(const Prototype& prototype) {
    MeshView out(prototype.mesh);
    out.origin = {};
    out.texture = prototype.texture;
    return out;
}

}  // namespace

void check_parts(const InstancedParts& parts, std::span<const MaterialFiles> of_surface) {
    validate(parts.prototypes, *parts.instances);
    std::set<std::string> prototypes, materials{MaterialFiles{}.name};
    for (const Prototype& prototype : parts.prototypes) {
        check_name(prototype.name, prototypes, "prototype");
        if (prototype.material >= parts.materials.size()) {
            throw InvalidInput(fmt::format("prototype '{}' refers to material {} of {}", prototype.name,
                                           prototype.material, parts.materials.size()));
        }
    }
    for (const MaterialFiles& material : of_surface) materials.insert(material.name);
    for (const MaterialFiles& material : parts.materials) check_name(material.name, materials, "material");
}

Vec3 compute_linear_color(std::array<std::uint8_t, 3> srgb) {
    static const std::array<float, 256> kDecoded = make_decoded();
    return {kDecoded[srgb[0]], kDecoded[srgb[1]], kDecoded[srgb[2]]};
}

CopyMesh::CopyMesh(const Prototype& prototype, const Instances* instances,
                   std::span<const std::uint32_t> copies, bool has_tangents, const Context& ctx)
    : prototype_(prototype),
      instances_(instances),
      copies_(copies),
      count_(instances != nullptr ? copies.size() : 1),
      given_(make_view(prototype)) {
    const bool for_tangents = has_tangents && !prototype.texture.empty();
    split_mesh(given_, for_tangents, split_, ctx);
    normals_ = smooth_normals(given_);
    if (split_) normals_ = split_vectors(normals_, *split_);
    if (for_tangents) tangents_ = compute_tangents(*split_, normals_, ctx);
}

Vec3 CopyMesh::turned(std::size_t v, Vec3 direction) const {
    if (!is_merged()) return direction;
    return rotate(instances_->rotations[copies_[v / view().positions.size()]], direction);
}

Vec3 CopyMesh::position(std::size_t v) const {
    const auto& positions = view().positions;
    const Vec3 p = positions[v % positions.size()];
    return is_merged() ? instances_->place(copies_[v / positions.size()], p) : p;
}

Vec3 CopyMesh::normal(std::size_t v) const { return normalized(turned(v, normals_[v % normals_.size()])); }

Tangent CopyMesh::tangent(std::size_t v) const {
    const Tangent& t = tangents_[v % tangents_.size()];
    return {normalized(turned(v, t.direction)), t.sign};
}

TexturePoint CopyMesh::texture(std::size_t v) const {
    const auto& places = split_->table.places;
    return places[v % places.size()];
}

std::array<std::uint8_t, 3> CopyMesh::color(std::size_t v) const {
    return instances_->colors[copies_[v / view().positions.size()]];
}

Triangle CopyMesh::triangle(std::size_t f) const {
    const auto corners = view().face(f % view().face_count);
    const auto base = static_cast<std::uint32_t>(f / view().face_count * view().positions.size());
    return {base + corners[0], base + corners[1], base + corners[2]};
}

CopyMeshes::CopyMeshes(const InstancedParts& parts, bool for_tangents, const Context& ctx)
    : copies(group_by(parts.instances->prototypes, parts.prototypes.size())) {
    const bool is_merged = parts.storage == InstanceStorage::merged;
    for (std::size_t p = 0; p < parts.prototypes.size(); ++p) {
        if (copies[p].empty()) continue;
        const Prototype& prototype = parts.prototypes[p];
        const bool has_tangents = for_tangents && !parts.materials[prototype.material].normal.empty();
        const CopyMesh& mesh = meshes.emplace_back(prototype, is_merged ? parts.instances : nullptr,
                                                   std::as_const(copies)[p], has_tangents, ctx);
        if (mesh.vertex_count() > std::numeric_limits<std::uint32_t>::max())
            throw Unsupported("the merged copies have more than 4,294,967,295 vertices; write instances");
    }
}

SurfaceWithCopies::SurfaceWithCopies(const MeshView& surface, const InstancedParts& parts,
                                     const Context& ctx) {
    const MergedInstances merged = merge_instances(parts.prototypes, *parts.instances, ctx);
    const std::size_t vertices = surface.positions.size(), corners = surface.first_corner(surface.face_count);
    const std::size_t all = vertices + merged.mesh.positions.size();
    if (all > std::numeric_limits<std::uint32_t>::max())
        throw Unsupported("the surface and its copies have more than 4,294,967,295 vertices");
    mesh.origin = surface.origin;
    mesh.positions.assign(surface.positions.begin(), surface.positions.end());
    mesh.positions.reserve(all);
    const Vec3 shift(merged.mesh.origin - surface.origin);
    for (const Vec3 p : merged.mesh.positions) mesh.positions.push_back(p + shift);
    mesh.corners.assign(surface.corners, surface.corners + corners);
    mesh.corners.reserve(corners + 3 * merged.mesh.triangles.size());
    mesh.first.reserve(surface.face_count + merged.mesh.triangles.size() + 1);
    for (std::size_t f = 0; f < surface.face_count; ++f)
        mesh.first.push_back(static_cast<std::uint32_t>(surface.first_corner(f + 1)));
    const auto base = static_cast<std::uint32_t>(vertices);
    for (const Triangle& t : merged.mesh.triangles)
        mesh.add_face(Triangle{base + t[0], base + t[1], base + t[2]});
    add_texture(surface, merged);
    for (const VertexAttribute& a : surface.attributes) {
        attributes.push_back(a);
        attributes.back().values.resize(all, -1.0f);
    }
    add_materials(surface, merged, parts);
}

void SurfaceWithCopies::add_texture(const MeshView& surface, const MergedInstances& merged) {
    mesh.texture.assign(surface.texture.begin(), surface.texture.end());
    mesh.texture.resize(surface.first_corner(surface.face_count), TexturePoint{});
    mesh.texture.insert(mesh.texture.end(), merged.texture.begin(), merged.texture.end());
    mesh.texture_blends.assign(surface.texture_blends.begin(), surface.texture_blends.end());
    if (!surface.texture_blends.empty()) mesh.texture_blends.resize(mesh.corners.size(), TextureBlend{});
}

void SurfaceWithCopies::add_materials(const MeshView& surface, const MergedInstances& merged,
                                      const InstancedParts& parts) {
    materials.assign(surface.materials.begin(), surface.materials.end());
    if (materials.empty()) materials.push_back({.base_color = Vec3(kPlainColor)});
    const auto first = static_cast<std::uint32_t>(materials.size());
    materials.insert(materials.end(), parts.materials.begin(), parts.materials.end());
    face_materials.assign(surface.face_materials.begin(), surface.face_materials.end());
    face_materials.resize(surface.face_count, 0);
    for (const std::uint32_t m : merged.materials) face_materials.push_back(first + m);
    groups.push_back({0, "tree"});
    for (std::size_t p = 0; p < parts.prototypes.size(); ++p) {
        if (merged.first_face[p] == merged.first_face[p + 1]) continue;
        groups.push_back({surface.face_count + merged.first_face[p], parts.prototypes[p].name});
    }
}

}  // namespace coppice::io_internal
