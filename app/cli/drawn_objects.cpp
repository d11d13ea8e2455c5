#include "drawn_objects.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "coppice/mesh/topology.h"
#include "coppice/render/colors.h"
#include "coppice/skeleton/assemble.h"
#include "files.h"

namespace coppice::cli {
namespace {

template <class Object>
struct Named {
    std::string file;
    Object object;
};

struct Loaded {
    std::vector<Named<MeshFile>> meshes;
    std::vector<Named<PointCloud>> clouds;
    std::vector<Named<SkeletonFile>> skeletons;
};

/// Chooses the colours of objects, and reports them.
class Colors {
  public:
    explicit Colors(Run& run) : run_(run) {}

    Rgb next(const std::string& file) {
        const Rgb color = numbered_color(count_++);
        run_.counts()["colors"][file] = fmt::format("#{:02x}{:02x}{:02x}", color[0], color[1], color[2]);
        return color;
    }

  private:
    Run& run_;
    std::size_t count_ = 0;
};

Loaded load(Run& run, std::span<const std::filesystem::path> files, const std::string& attribute,
            const ReadSkeletonOptions& read, const ReadPointsOptions& read_points) {
    Loaded out;
    const std::span attributes(&attribute, attribute.empty() ? 0 : 1);
    for (const std::filesystem::path& path : files) {
        const FileKind kind = kind_of_input(run, path, read.format);
        if (kind == FileKind::skeleton) {
            out.skeletons.push_back({path.string(), load_skeleton(run, path, read)});
        } else if (kind == FileKind::points) {
            PointColumns columns = kNoColumns;
            columns.distances = columns.colors = true;
            out.clouds.push_back(
                {path.string(), load_point_file(run, path, columns, read.up, read_points).point_cloud});
        } else {
            out.meshes.push_back({path.string(), load_mesh_file(run, path, attributes, read.up)});
            validate(out.meshes.back().object.mesh);
        }
    }
    return out;
}

void append(PolygonMesh& mesh, const PolygonMesh& other) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const Vec3d shift = other.origin - mesh.origin;
    for (const Vec3 p : other.positions) mesh.positions.push_back(Vec3(Vec3d(p) + shift));
    std::vector<std::uint32_t> face;
    for (std::uint32_t f = 0; f < other.face_count(); ++f) {
        face.clear();
        for (const std::uint32_t v : other.face(f)) face.push_back(first + v);
        mesh.add_face(face);
    }
}

/// Meshes without the attribute have NaN.
void join_values(std::span<const Named<MeshFile>> meshes, DrawnObjects& out) {
    if (std::ranges::all_of(meshes, [](const auto& named) { return named.object.attributes.empty(); }))
        return;
    for (const auto& [name, file] : meshes) {
        const std::size_t end = out.vertex_values.size() + file.mesh.positions.size();
        if (!file.attributes.empty()) {
            const Buffer<float>& values = file.attributes.front().values;
            out.vertex_values.insert(out.vertex_values.end(), values.begin(), values.end());
        }
        out.vertex_values.resize(end, std::numeric_limits<float>::quiet_NaN());
    }
}

void join_meshes(std::vector<Named<MeshFile>> meshes, Colors& colors, DrawnObjects& out) {
    out.mesh_count = meshes.size();
    if (meshes.empty()) return;
    join_values(meshes, out);
    if (meshes.size() == 1) {
        out.mesh = std::move(meshes.front().object.mesh);
        return;
    }
    out.mesh.emplace();
    out.mesh->origin = meshes.front().object.mesh.origin;
    for (const auto& [name, file] : meshes) {
        append(*out.mesh, file.mesh);
        out.mesh_colors.resize(out.mesh->positions.size(), colors.next(name));
    }
}

/// Points with colours keep them.
void join_clouds(std::vector<Named<PointCloud>> clouds, Colors& colors, DrawnObjects& out) {
    if (clouds.empty()) return;
    out.cloud = std::move(clouds.front().object);
    if (clouds.size() == 1) return;
    PointCloud& all = *out.cloud;
    all.colors.resize(all.points.size(), all.colors.empty() ? colors.next(clouds.front().file) : Rgb{});
    for (std::size_t i = 1; i < clouds.size(); ++i) {
        const PointCloud& next = clouds[i].object;
        const bool measured = all.distances.size() == all.points.size() && !next.distances.empty();
        all.points = merged(all.points, next.points);
        if (measured) all.distances.insert(all.distances.end(), next.distances.begin(), next.distances.end());
        if (!measured) all.distances.clear();
        all.colors.insert(all.colors.end(), next.colors.begin(), next.colors.end());
        if (next.colors.empty()) all.colors.resize(all.points.size(), colors.next(clouds[i].file));
    }
}

void join_skeletons(std::vector<Named<SkeletonFile>> files, Colors& colors, DrawnObjects& out) {
    if (files.empty()) return;
    std::vector<const Skeleton*> parts;
    bool has_evidence = true;
    for (const auto& [name, file] : files) {
        parts.push_back(&file.skeleton);
        const auto evidence = file.attribute("evidence");
        has_evidence = has_evidence && !evidence.empty();
        out.evidence.insert(out.evidence.end(), evidence.begin(), evidence.end());
        if (files.size() > 1)
            out.skeleton_colors.insert(out.skeleton_colors.end(), file.skeleton.size(), colors.next(name));
    }
    if (!has_evidence) out.evidence.clear();
    out.skeleton = parts.size() == 1 ? std::move(files.front().object.skeleton) : joined(parts);
}

}  // namespace

DrawnObjects load_drawn_objects(Run& run, std::span<const std::filesystem::path> files,
                                const std::string& attribute, const ReadSkeletonOptions& read,
                                const ReadPointsOptions& read_points) {
    Loaded loaded = load(run, files, attribute, read, read_points);
    DrawnObjects out;
    Colors colors(run);
    join_meshes(std::move(loaded.meshes), colors, out);
    join_clouds(std::move(loaded.clouds), colors, out);
    join_skeletons(std::move(loaded.skeletons), colors, out);
    return out;
}

}  // namespace coppice::cli
