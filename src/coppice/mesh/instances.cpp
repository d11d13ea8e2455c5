#include "coppice/mesh/instances.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/error.h"
#include "coppice/base/parallel.h"

namespace coppice {
namespace {

constexpr std::size_t kGrain = 1024;

void validate(const Prototype& prototype) {
    const TriMesh& mesh = prototype.mesh;
    if (mesh.triangles.empty())
        throw InvalidInput(fmt::format("prototype '{}' has no triangles", prototype.name));
    if (!prototype.texture.empty() && prototype.texture.size() != 3 * mesh.triangles.size()) {
        throw InvalidInput(fmt::format("prototype '{}' has {} texture coordinates for {} corners",
                                       prototype.name, prototype.texture.size(), 3 * mesh.triangles.size()));
    }
}

bool is_unit(Quaternion r) {
    constexpr float kTolerance = 1e-3f;
    return std::abs(std::sqrt(r.x * r.x + r.y * r.y + r.z * r.z + r.w * r.w) - 1) <= kTolerance;
}

/// Numbers of elements of the merged mesh before the copies of each prototype, and the totals.
struct Offsets {
    std::vector<std::size_t> vertices{0}, faces{0};

    Offsets(std::span<const Prototype> prototypes, const CompressedRows<std::uint32_t>& copies) {
        for (std::size_t p = 0; p < prototypes.size(); ++p) {
            const TriMesh& mesh = prototypes[p].mesh;
            vertices.push_back(vertices.back() + copies[p].size() * mesh.positions.size());
            faces.push_back(faces.back() + copies[p].size() * mesh.triangles.size());
        }
    }
};

/// Writes one copy of a prototype.
void place_copy(const Prototype& prototype, const Instances& instances, std::uint32_t copy,
                std::size_t first_vertex, std::size_t first_face, MergedInstances& out) {
    const TriMesh& mesh = prototype.mesh;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        out.mesh.positions[first_vertex + v] = instances.place(copy, mesh.positions[v]);
        out.colors[first_vertex + v] = instances.colors[copy];
    }
    const auto base = static_cast<std::uint32_t>(first_vertex);
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        const Triangle& t = mesh.triangles[f];
        out.mesh.triangles[first_face + f] = {base + t[0], base + t[1], base + t[2]};
        out.materials[first_face + f] = prototype.material;
        for (std::size_t k = 0; k < 3; ++k) {
            out.texture[3 * (first_face + f) + k] =
                prototype.texture.empty() ? TexturePoint{} : prototype.texture[3 * f + k];
        }
    }
}

}  // namespace

void validate(std::span<const Prototype> prototypes, const Instances& instances) {
    for (const Prototype& prototype : prototypes) validate(prototype);
    const std::size_t n = instances.size();
    for (const std::size_t other : {instances.prototypes.size(), instances.rotations.size(),
                                    instances.scales.size(), instances.colors.size()}) {
        if (other != n) throw InvalidInput("the vectors of the instances have different lengths");
    }
    for (std::size_t i = 0; i < n; ++i) {
        const auto fail = [&](std::string_view fault) {
            throw InvalidInput(fmt::format("copy {} {}", i, fault));
        };
        if (instances.prototypes[i] >= prototypes.size()) {
            fail(fmt::format("refers to prototype {} of {}", instances.prototypes[i], prototypes.size()));
        }
        if (!is_finite(instances.positions[i])) fail("has no finite position");
        if (!is_unit(instances.rotations[i])) fail("has a rotation that is not of unit length");
        if (!(instances.scales[i] > 0 && std::isfinite(instances.scales[i])))
            fail("has a scale that is not > 0");
    }
    if (!is_finite(instances.origin)) throw InvalidInput("the origin of the instances is not finite");
}

Box3 compute_bounds(std::span<const Prototype> prototypes, const Instances& instances, const Context& ctx) {
    const auto box_of_range = [&](IndexRange range) {
        Box3 box;
        for (std::size_t i = range.begin; i < range.end; ++i) {
            for (const Vec3 v : prototypes[instances.prototypes[i]].mesh.positions)
                box.extend(instances.place(i, v));
        }
        return box;
    };
    return parallel_reduce(ctx, instances.size(), kGrain, Box3{}, box_of_range, [](Box3 a, const Box3& b) {
        a.extend(b);
        return a;
    });
}

MergedInstances merge_instances(std::span<const Prototype> prototypes, const Instances& instances,
                                const Context& ctx) {
    const auto copies = group_by(instances.prototypes, prototypes.size());
    const Offsets first(prototypes, copies);
    if (first.vertices.back() > std::numeric_limits<std::uint32_t>::max()) {
        throw Unsupported(fmt::format(
            "the copies have {} vertices together, more than 4,294,967,295; use simpler prototypes",
            first.vertices.back()));
    }
    MergedInstances out;
    out.mesh.origin = instances.origin;
    out.mesh.positions.resize(first.vertices.back());
    out.colors.resize(first.vertices.back());
    out.mesh.triangles.resize(first.faces.back());
    out.materials.resize(first.faces.back());
    out.texture.resize(3 * first.faces.back());
    out.first_face = first.faces;
    parallel_for(ctx, copies.items.size(), kGrain, [&](std::size_t i) {
        const std::uint32_t copy = copies.items[i], p = instances.prototypes[copy];
        const std::size_t number = i - copies.first[p];
        const TriMesh& mesh = prototypes[p].mesh;
        place_copy(prototypes[p], instances, copy, first.vertices[p] + number * mesh.positions.size(),
                   first.faces[p] + number * mesh.triangles.size(), out);
    });
    return out;
}

double estimate_merged_bytes(std::span<const Prototype> prototypes, const Instances& instances) {
    constexpr double kBytesOfVertex = sizeof(Vec3) + 3;
    constexpr double kBytesOfFace = sizeof(Triangle) + 3 * sizeof(TexturePoint) + sizeof(std::uint32_t);
    double bytes = sizeof(std::uint32_t) * static_cast<double>(instances.size());
    for (const std::uint32_t p : instances.prototypes) {
        bytes += kBytesOfVertex * static_cast<double>(prototypes[p].mesh.positions.size()) +
                 kBytesOfFace * static_cast<double>(prototypes[p].mesh.triangles.size());
    }
    return bytes;
}

}  // namespace coppice
