#include "coppice/io_mesh/writer.h"

#include <fmt/format.h>

#include "coppice/io_mesh/copies_internal.h"
#include "coppice/io_mesh/material_internal.h"
#include "coppice/io_mesh/write_internal.h"

namespace coppice {
namespace io_internal {

std::vector<Vec3> smooth_normals(const MeshView& mesh) {
    std::vector<Vec3> normals(mesh.positions.size());
    for (std::size_t f = 0; f < mesh.face_count; ++f) {
        const auto corners = mesh.face(f);
        const Vec3 p = mesh.positions[corners[0]];
        Vec3 sum;
        for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
            sum += cross(mesh.positions[corners[k]] - p, mesh.positions[corners[k + 1]] - p);
        }
        for (const std::uint32_t v : corners) normals[v] += sum;
    }
    for (Vec3& n : normals) n = Vec3(normalized(Vec3d(n)));
    return normals;
}

namespace {

void check_mesh(const std::filesystem::path& path, const MeshView& mesh, const Context& ctx) {
    if (mesh.face_count == 0) {
        throw InvalidInput(fmt::format("cannot write {}: the mesh has no faces", path.string()));
    }
    const std::size_t size = mesh.positions.size();
    const auto first_bad = [&](IndexRange range) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            if (!is_finite(mesh.positions[i])) return i;
        }
        return size;
    };
    const auto bad = parallel_reduce(ctx, size, std::size_t{1} << 16, size, first_bad,
                                     [](std::size_t a, std::size_t b) { return std::min(a, b); });
    if (bad != size || !is_finite(mesh.origin)) {
        throw InvalidInput(fmt::format("cannot write {}: {} is not finite", path.string(),
                                       bad != size ? fmt::format("vertex {}", bad) : "the origin"));
    }
}

MeshFormat format_for(const std::filesystem::path& path, const MeshWriteOptions& options) {
    const auto format = options.format ? options.format : mesh_format_of_name(path);
    if (!format || *format == MeshFormat::off) {
        throw Unsupported(fmt::format(
            "cannot write {}: a mesh file must have the extension .obj, .ply, .stl, .glb or .usda",
            path.string()));
    }
    return *format;
}

/// Calls `write(file)` and adds the name of the file to errors about the limits of a format.
template <class Write>
void write_whole(const std::filesystem::path& path, const MeshView& mesh, const Context& ctx,
                 const Write& write) {
    check_mesh(path, mesh, ctx);
    AtomicFile file(path);
    try {
        write(file);
    } catch (const Unsupported& e) {
        throw Unsupported(fmt::format("cannot write {}: {}", path.string(), e.what()));
    }
    file.commit();
    ctx.report(1);
}

/// Returns whether the format does not specify its up axis.
bool has_no_up(MeshFormat format) {
    return format == MeshFormat::obj || format == MeshFormat::ply || format == MeshFormat::stl;
}

void write_view(const std::filesystem::path& path, MeshView mesh, const MeshWriteOptions& options,
                const Context& ctx) {
    const MeshFormat format = format_for(path, options);
    mesh.texture = options.texture;
    if (format != MeshFormat::obj && format != MeshFormat::stl) mesh.texture_blends = options.texture_blends;
    mesh.attributes = options.attributes;
    mesh.path = path;
    set_materials(mesh, options.materials, options.face_materials);
    COPPICE_ASSERT(mesh.texture.empty() || mesh.texture.size() == mesh.first_corner(mesh.face_count));
    COPPICE_ASSERT(mesh.texture_blends.empty() || mesh.texture_blends.size() == mesh.texture.size());
    for (const VertexAttribute& a : mesh.attributes) COPPICE_ASSERT(a.values.size() == mesh.positions.size());
    std::vector<Vec3> turned, normals;
    if (options.up != FileUp::z && has_no_up(format)) {
        turned.reserve(mesh.positions.size());
        for (const Vec3 p : mesh.positions) turned.push_back(to_file(p, options.up));
        mesh.positions = turned;
        mesh.origin = to_file(mesh.origin, options.up);
        mesh.up = options.up;
    }
    if (options.normals && format == MeshFormat::obj) {
        normals = smooth_normals(mesh);
        mesh.normals = normals;
    }
    write_whole(path, mesh, ctx, [&](AtomicFile& file) {
        switch (format) {
            case MeshFormat::obj:
                write_obj(file, mesh, ctx);
                // Not earlier: a file that fails must not leave its library.
                if (!mesh.materials.empty()) write_mtl(path, list_used_materials(mesh));
                return;
            case MeshFormat::ply:
                return write_ply(file, mesh, ctx);
            case MeshFormat::stl:
                return write_stl(file, mesh, ctx);
            case MeshFormat::glb:
                return write_glb(file, mesh, ctx);
            case MeshFormat::usda:
                return write_usda(file, mesh, Subdivision::none, ctx);
            case MeshFormat::off:
                break;  // refused by format_for
        }
    });
}

/// Writes a surface and its copies.
void write_surface(const std::filesystem::path& path, MeshView surface, const MeshWriteOptions& options,
                   const Context& ctx) {
    if (options.parts.empty()) return write_view(path, surface, options, ctx);
    check_parts(options.parts, options.materials);
    const MeshFormat format = format_for(path, options);
    if (format == MeshFormat::glb || format == MeshFormat::usda) {
        surface.parts = &options.parts;
        return write_view(path, surface, options, ctx);
    }
    surface.texture = options.texture;
    surface.texture_blends = options.texture_blends;
    surface.attributes = options.attributes;
    set_materials(surface, options.materials, options.face_materials);
    const SurfaceWithCopies whole(surface, options.parts, ctx);
    MeshView view(whole.mesh);
    view.materials = whole.materials;
    view.face_materials = whole.face_materials;
    view.groups = whole.groups;
    write_view(path, view,
               {.format = format,
                .up = options.up,
                .normals = options.normals,
                .texture = whole.mesh.texture,
                .texture_blends = whole.mesh.texture_blends,
                .attributes = whole.attributes},
               ctx);
}

}  // namespace
}  // namespace io_internal

void write_mesh(const std::filesystem::path& path, const QuadMesh& mesh, const MeshWriteOptions& options,
                const Context& ctx) {
    io_internal::write_surface(path, io_internal::MeshView(mesh), options, ctx);
}

void write_mesh(const std::filesystem::path& path, const TriMesh& mesh, const MeshWriteOptions& options,
                const Context& ctx) {
    io_internal::write_surface(path, io_internal::MeshView(mesh), options, ctx);
}

void write_mesh(const std::filesystem::path& path, const PolygonMesh& mesh, const MeshWriteOptions& options,
                const Context& ctx) {
    io_internal::write_surface(path, io_internal::MeshView(mesh), options, ctx);
}

void write_cage(const std::filesystem::path& path, const QuadMesh& cage, const Context& ctx) {
    const io_internal::MeshView view(cage);
    io_internal::write_whole(path, view, ctx, [&](AtomicFile& file) {
        io_internal::write_usda(file, view, io_internal::Subdivision::catmull_clark, ctx);
    });
}

}  // namespace coppice
