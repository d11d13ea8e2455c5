#include "results.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "coppice/io_points/writer.h"
#include "coppice/render/png.h"
#include "coppice/scene/save.h"
#include "held_objects.h"
#include "pictures.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

void hold(Run& run, const std::filesystem::path& name, SkeletonFile file) {
    run.host().held_objects()->put(name, std::make_shared<const SkeletonFile>(std::move(file)));
}

void hold(Run& run, const std::filesystem::path& name, HeldSurface surface) {
    run.host().held_objects()->put(name, std::make_shared<const HeldSurface>(std::move(surface)));
}

void hold(Run& run, const std::filesystem::path& name, PointFile file) {
    run.host().held_objects()->put(name, std::make_shared<const PointFile>(std::move(file)));
}

}  // namespace

bool is_held(const Run& run, const std::filesystem::path& path) {
    return run.host().held_objects() != nullptr && HeldObjects::is_name(path);
}

bool is_held_only(const Run& run, std::span<const std::filesystem::path> paths) {
    return std::ranges::all_of(paths, [&](const auto& path) { return is_held(run, path); });
}

void store_skeleton(Run& run, const std::filesystem::path& path, const Skeleton& skeleton,
                    const WriteSkeletonOptions& options, std::span<const NodeAttribute> attributes,
                    const Context& ctx) {
    if (!is_held(run, path)) return write_skeleton(path, skeleton, options, attributes, ctx);
    SkeletonFile file{.skeleton = skeleton,
                      .report = {},
                      .format = "memory",
                      .units = options.units,
                      .notes = {},
                      .attributes = {attributes.begin(), attributes.end()}};
    if (file.units == LengthUnit::automatic) file.units = LengthUnit::m;
    hold(run, path, std::move(file));
}

void store_surface(Run& run, const std::filesystem::path& path, const MeshResult& result,
                   const MeshWriteOptions& options, const Context& ctx,
                   std::shared_ptr<const SurfaceLeaves> leaves) {
    if (!is_held(run, path)) return write_surface(path, result, options, ctx);
    HeldSurface held{
        .mesh = std::visit([](const auto& surface) -> decltype(HeldSurface::mesh) { return surface.mesh; },
                           result.surface),
        .attributes = result.attributes,
        .slots = result.slots,
        .leaves = std::move(leaves)};
    if (const auto* tubes = std::get_if<CylinderMesh>(&result.surface)) held.texture = tubes->texture;
    if (result.texture) {
        held.texture = result.texture->points;
        held.blends = result.texture->blends;
    }
    hold(run, path, std::move(held));
}

void store_mesh(Run& run, const std::filesystem::path& path, const PolygonMesh& mesh,
                const MeshWriteOptions& options, const Context& ctx) {
    if (!is_held(run, path)) return write_mesh(path, mesh, options, ctx);
    hold(run, path, HeldSurface{.mesh = mesh, .texture = mesh.texture, .blends = mesh.texture_blends});
}

void store_points(Run& run, const std::filesystem::path& path, const PointCloud& point_cloud,
                  const CoordinateSystem& system, const Context& ctx) {
    if (!is_held(run, path)) return write_point_cloud(path, point_cloud, {.system = system}, ctx);
    hold(run, path, PointFile{.point_cloud = point_cloud, .format = "memory", .system = system});
}

void store_object(Run& run, const std::filesystem::path& path, const SceneObject& object,
                  InstanceStorage storage, const Context& ctx) {
    if (!is_held(run, path)) return save_object(object, path, storage, ctx);
    check_file_name(object, path);
    if (const auto* points = std::get_if<PointSet>(&object.value)) {
        store_points(run, path, PointCloud{*points, {}, {}}, {}, ctx);
    } else if (const auto* skeleton = std::get_if<Skeleton>(&object.value)) {
        store_skeleton(run, path, *skeleton, {}, object.attributes, ctx);
    } else {
        const auto& surface = std::get<Surface>(object.value);
        HeldSurface held{.mesh = surface.mesh,
                         .texture = surface.texture,
                         .blends = surface.texture_blends,
                         .slots = surface.slots,
                         .leaves = surface.leaves};
        if (const auto* polygons = std::get_if<PolygonMesh>(&surface.mesh);
            polygons != nullptr && held.texture.empty()) {
            held.texture = polygons->texture;
            held.blends = polygons->texture_blends;
        }
        hold(run, path, std::move(held));
    }
}

void store_picture(Run& run, const std::filesystem::path& path, const Image& image) {
    if (!is_held(run, path)) return write_picture(path, image);
    run.host().held_objects()->put(path, std::make_shared<const std::string>(encode_png(image)));
}

}  // namespace coppice::cli
