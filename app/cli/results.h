#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "coppice/io_mesh/instanced_parts.h"
#include "coppice/io_mesh/writer.h"
#include "coppice/io_points/reader.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/pipeline/mesh_result.h"
#include "coppice/render/image.h"
#include "coppice/scene/object.h"
#include "coppice/scene/surface_leaves.h"
#include "run.h"

namespace coppice::cli {

/// Returns whether an output is an object in the memory of the caller instead of a file.
bool is_held(const Run& run, const std::filesystem::path& path);
/// Returns whether all outputs are.
bool is_held_only(const Run& run, std::span<const std::filesystem::path> paths);

// Each function writes a result to a file, or stores it in memory if is_held(). Throws as the writers do.

/// Stores a skeleton. Options and attributes are those of write_skeleton().
void store_skeleton(Run& run, const std::filesystem::path& path, const Skeleton& skeleton,
                    const WriteSkeletonOptions& options, std::span<const NodeAttribute> attributes,
                    const Context& ctx);

/// Stores the surface of any method, see write_surface(). In memory it has these leaves; files have the parts
/// of the options.
void store_surface(Run& run, const std::filesystem::path& path, const MeshResult& result,
                   const MeshWriteOptions& options, const Context& ctx,
                   std::shared_ptr<const SurfaceLeaves> leaves = {});

/// Stores polygons.
void store_mesh(Run& run, const std::filesystem::path& path, const PolygonMesh& mesh,
                const MeshWriteOptions& options, const Context& ctx);

/// Stores points with their attributes.
void store_points(Run& run, const std::filesystem::path& path, const PointCloud& point_cloud,
                  const CoordinateSystem& system, const Context& ctx);

/// Stores points, a skeleton or a surface of a scene.
void store_object(Run& run, const std::filesystem::path& path, const SceneObject& object,
                  InstanceStorage storage, const Context& ctx);

/// Stores an image as PNG.
void store_picture(Run& run, const std::filesystem::path& path, const Image& image);

}  // namespace coppice::cli
