#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coppice/io_points/reader.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/mesh/mesh.h"
#include "coppice/points/point_cloud.h"
#include "run.h"

namespace coppice::cli {

/// The objects of an image, those of each kind in one. Where there are several of a kind, each has its own
/// colour.
struct DrawnObjects {
    std::optional<PolygonMesh> mesh;
    std::optional<PointCloud> cloud;
    std::optional<Skeleton> skeleton;
    std::vector<float> evidence;       ///< per node of the skeleton; empty if a skeleton has none
    std::vector<Rgb> mesh_colors;      ///< per vertex; empty for a single mesh
    std::vector<Rgb> skeleton_colors;  ///< per node; empty for a single skeleton
    std::vector<float> vertex_values;  ///< per vertex, of an attribute; empty if no mesh has it
    std::size_t mesh_count = 0;
};

/// Reads meshes, points and skeletons in any order, and joins those of each kind relative to the origin of
/// the first. The report has the colours of files. `attribute` names the numbers of the vertices of meshes to
/// read; may be empty. Throws as the readers do.
DrawnObjects load_drawn_objects(Run& run, std::span<const std::filesystem::path> files,
                                const std::string& attribute, const ReadSkeletonOptions& read,
                                const ReadPointsOptions& read_points);

}  // namespace coppice::cli
