#include <fmt/format.h>

#include <cmath>
#include <concepts>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "coppice/base/local_origin.h"
#include "coppice/mesh/normals.h"
#include "coppice/options/figures.h"
#include "coppice/skeleton/raw.h"
#include "figures.h"
#include "task_internal.h"

using coppice::Vec3;
using coppice::Vec3d;
using coppice::cli::HeldObject;
using coppice::cli::HeldSurface;

// The arrays are those of the library.
static_assert(sizeof(Vec3) == 3 * sizeof(float));
static_assert(sizeof(coppice::NodeId) == sizeof(std::int32_t));
static_assert(sizeof(coppice::TexturePoint) == 2 * sizeof(float));
static_assert(sizeof(coppice::Quaternion) == 4 * sizeof(float));
static_assert(sizeof(coppice::Quad) == 4 * sizeof(std::uint32_t));

namespace {

template <class Object>
const Object* find(const coppice_object* object) {
    const auto* found = std::get_if<std::shared_ptr<const Object>>(&object->held);
    return found == nullptr ? nullptr : found->get();
}

const float* numbers(const Vec3* values) { return reinterpret_cast<const float*>(values); }

void copy(Vec3d from, double (&to)[3]) {
    for (int axis = 0; axis < 3; ++axis) to[axis] = from[axis];
}

template <class Values>
auto data_or_null(const Values& values) {
    return values.empty() ? nullptr : values.data();
}

/// Returns the number of corners of every face; 0 if they differ, or there are no faces.
std::size_t find_face_size(const coppice::PolygonMesh& mesh) {
    if (mesh.face_count() == 0) return 0;
    const std::size_t size = mesh.first[1];
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
        if (mesh.first[f + 1] - mesh.first[f] != size) return 0;
    return size;
}

void get_faces(const coppice::QuadMesh& mesh, coppice_surface_arrays& out) {
    out.face_count = mesh.quads.size();
    out.face_size = 4;
    out.corner_count = 4 * out.face_count;
    out.corners = reinterpret_cast<const std::uint32_t*>(mesh.quads.data());
}

void get_faces(const coppice::TriMesh& mesh, coppice_surface_arrays& out) {
    out.face_count = mesh.triangles.size();
    out.face_size = 3;
    out.corner_count = 3 * out.face_count;
    out.corners = reinterpret_cast<const std::uint32_t*>(mesh.triangles.data());
}

void get_faces(const coppice::PolygonMesh& mesh, coppice_surface_arrays& out) {
    out.face_count = mesh.face_count();
    out.face_size = find_face_size(mesh);
    out.corner_count = mesh.corners.size();
    out.corners = mesh.corners.data();
    if (out.face_size == 0) out.first = mesh.first.data();
}

coppice::Buffer<Vec3> normals_of(const coppice::QuadMesh& mesh) {
    return coppice::smooth_normals(mesh.positions, mesh.quads);
}

coppice::Buffer<Vec3> normals_of(const coppice::TriMesh& mesh) { return coppice::smooth_normals(mesh); }

coppice::Buffer<Vec3> normals_of(const coppice::PolygonMesh& mesh) {
    std::vector<Vec3> sums(mesh.positions.size());
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
        const auto face = mesh.face(f);
        Vec3 sum;
        for (std::size_t k = 1; k + 1 < face.size(); ++k)
            sum += cross(mesh.positions[face[k]] - mesh.positions[face[0]],
                         mesh.positions[face[k + 1]] - mesh.positions[face[0]]);
        for (const std::uint32_t v : face) sums[v] += sum;
    }
    coppice::Buffer<Vec3> out(sums.size());
    for (std::size_t v = 0; v < sums.size(); ++v) out[v] = normalized(sums[v]);
    return out;
}

/// Returns the position of an index in an array of coordinates. Throws InvalidInput if it is not finite or
/// too large.
Vec3d position_at(const double* positions, std::size_t i, const char* thing) {
    const Vec3d p{positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(p[axis]) <= 1e15) continue;  // false for NaN
        throw coppice::InvalidInput(fmt::format(
            "{} {} has the coordinate {}; use finite numbers from -1e15 to 1e15", thing, i, p[axis]));
    }
    return p;
}

/// Copies positions relative to an origin that preserves their precision, which is returned.
Vec3d copy_positions(const double* positions, std::size_t count, const char* thing,
                     coppice::Buffer<Vec3>& out) {
    if (count >= coppice::kNoIndex)
        throw coppice::InvalidInput(
            fmt::format("there are {} {} positions; the maximum is {}", count, thing, coppice::kNoIndex - 1));
    std::vector<Vec3d> all(count);
    for (std::size_t i = 0; i < count; ++i) all[i] = position_at(positions, i, thing);
    const Vec3d origin = count > 0 ? coppice::local_origin(all) : Vec3d{};
    out.resize(count);
    for (std::size_t i = 0; i < count; ++i) out[i] = Vec3(all[i] - origin);
    return origin;
}

std::uint32_t corner_at(const coppice_faces& faces, std::size_t i) {
    const std::int64_t corner = faces.corners[i];
    if (corner >= 0 && static_cast<std::uint64_t>(corner) < faces.vertex_count)
        return static_cast<std::uint32_t>(corner);
    throw coppice::InvalidInput(fmt::format("face {} has the vertex {}; there are vertices from 0 to {}",
                                            i / faces.face_size, corner,
                                            static_cast<std::int64_t>(faces.vertex_count) - 1));
}

HeldSurface make_surface(const coppice_faces& faces) {
    if (faces.face_size < 3)
        throw coppice::InvalidInput(fmt::format("faces have {} corners; use at least 3", faces.face_size));
    if (faces.face_count >= coppice::kNoIndex / faces.face_size)
        throw coppice::InvalidInput(fmt::format("there are {} faces; use fewer", faces.face_count));
    coppice::PolygonMesh polygons;
    polygons.origin = copy_positions(faces.positions, faces.vertex_count, "vertex", polygons.positions);
    const std::size_t corners = faces.face_count * faces.face_size;
    polygons.corners.resize(corners);
    for (std::size_t i = 0; i < corners; ++i) polygons.corners[i] = corner_at(faces, i);
    polygons.first.resize(faces.face_count + 1);
    for (std::size_t f = 0; f <= faces.face_count; ++f)
        polygons.first[f] = static_cast<std::uint32_t>(f * faces.face_size);
    return {.mesh = std::move(polygons)};
}

coppice::SkeletonFile make_skeleton(const coppice_nodes& nodes) {
    std::vector<coppice::RawNode> raw(nodes.count);
    for (std::size_t i = 0; i < nodes.count; ++i) {
        raw[i].id = nodes.ids != nullptr ? nodes.ids[i] : static_cast<std::int64_t>(i);
        raw[i].parent = nodes.parents[i];
        raw[i].position = position_at(nodes.positions, i, "node");
        raw[i].radius = nodes.radii[i];
    }
    coppice::RepairResult made = coppice::repair(raw, "skeleton");
    return {.skeleton = std::move(made.skeleton),
            .report = made.report,
            .format = "memory",
            .notes = {},
            .attributes = {}};
}

template <class Object>
coppice_object* make_object(Object object) {
    return new coppice_object{HeldObject(std::make_shared<const Object>(std::move(object)))};
}

/// Returns the attributes of the nodes or vertices through visit(name, values) of the one at an index, and
/// their number.
template <class Visit>
std::size_t visit_attribute(const coppice_object* object, std::size_t index, const Visit& visit) {
    const auto pick = [&](const auto& attributes) {
        if (index < attributes.size()) visit(attributes[index].name.c_str(), attributes[index].values.data());
        return attributes.size();
    };
    if (const auto* file = find<coppice::SkeletonFile>(object)) return pick(file->attributes);
    if (const auto* surface = find<HeldSurface>(object)) return pick(surface->attributes);
    return 0;
}

}  // namespace

void coppice_object_free(coppice_object* object) { delete object; }

coppice_kind coppice_object_kind(const coppice_object* object) {
    return static_cast<coppice_kind>(object->held.index());
}

coppice_status coppice_skeleton_get(const coppice_object* skeleton, coppice_skeleton_arrays* arrays) {
    const auto* file = find<coppice::SkeletonFile>(skeleton);
    if (file == nullptr) return COPPICE_WRONG_USAGE;
    const coppice::Skeleton& s = file->skeleton;
    *arrays = {.count = s.size(),
               .positions = numbers(s.positions().data()),
               .radii = s.radii().data(),
               .parents = reinterpret_cast<const std::int32_t*>(s.parents().data()),
               .origin = {},
               .units = coppice::name_of(file->units).data()};
    copy(s.origin(), arrays->origin);
    return COPPICE_OK;
}

coppice_status coppice_surface_get(const coppice_object* surface, coppice_surface_arrays* arrays) {
    const auto* held = find<HeldSurface>(surface);
    if (held == nullptr) return COPPICE_WRONG_USAGE;
    *arrays = {};
    std::visit(
        [&](const auto& mesh) {
            arrays->vertex_count = mesh.positions.size();
            arrays->positions = numbers(mesh.positions.data());
            copy(mesh.origin, arrays->origin);
            get_faces(mesh, *arrays);
        },
        held->mesh);
    arrays->texture = reinterpret_cast<const float*>(data_or_null(held->texture));
    arrays->material_slots = data_or_null(held->slots);
    return COPPICE_OK;
}

coppice_status coppice_surface_normals(const coppice_object* surface, float* normals) {
    const auto* held = find<HeldSurface>(surface);
    if (held == nullptr) return COPPICE_WRONG_USAGE;
    return static_cast<coppice_status>(coppice::cli::catch_errors(
        [&] {
            const auto all = std::visit([](const auto& mesh) { return normals_of(mesh); }, held->mesh);
            std::copy_n(numbers(all.data()), 3 * all.size(), normals);
            return coppice::cli::kDone;
        },
        [](const char*) {}));
}

coppice_status coppice_instances_get(const coppice_object* surface, coppice_instances_arrays* arrays) {
    const auto* held = find<HeldSurface>(surface);
    if (held == nullptr) return COPPICE_WRONG_USAGE;
    *arrays = {};
    if (!held->leaves) return COPPICE_OK;
    const coppice::Instances& instances = held->leaves->tree.foliage.instances;
    arrays->count = instances.size();
    arrays->prototypes = data_or_null(instances.prototypes);
    arrays->positions = numbers(data_or_null(instances.positions));
    arrays->rotations = reinterpret_cast<const float*>(data_or_null(instances.rotations));
    arrays->scales = data_or_null(instances.scales);
    arrays->colors = instances.colors.empty() ? nullptr : instances.colors.front().data();
    copy(instances.origin, arrays->origin);
    arrays->prototype_count = held->leaves->tree.prototypes.size();
    return COPPICE_OK;
}

coppice_status coppice_prototype_get(const coppice_object* surface, size_t index,
                                     coppice_prototype* prototype) {
    const auto* held = find<HeldSurface>(surface);
    if (held == nullptr || !held->leaves || index >= held->leaves->tree.prototypes.size())
        return COPPICE_WRONG_USAGE;
    return static_cast<coppice_status>(coppice::cli::catch_errors(
        [&] {
            const coppice::Prototype& part = held->leaves->tree.prototypes[index];
            *prototype = {
                .name = part.name.c_str(), .mesh = nullptr, .color = {}, .image = nullptr, .image_size = 0};
            const auto& materials = held->leaves->materials;
            if (part.material < materials.size()) {
                const coppice::MaterialFiles& material = materials[part.material];
                for (int k = 0; k < 3; ++k) prototype->color[k] = material.base_color[k];
                if (const auto image = material.bytes.find(material.color); image != material.bytes.end()) {
                    prototype->image = image->second.data();
                    prototype->image_size = image->second.size();
                }
            }
            HeldSurface mesh{.mesh = part.mesh};
            mesh.texture.assign(part.texture.begin(), part.texture.end());
            prototype->mesh = make_object(std::move(mesh));
            return coppice::cli::kDone;
        },
        [](const char*) {}));
}

coppice_status coppice_points_get(const coppice_object* points, coppice_points_arrays* arrays) {
    const auto* file = find<coppice::PointFile>(points);
    if (file == nullptr) return COPPICE_WRONG_USAGE;
    const coppice::PointCloud& cloud = file->point_cloud;
    *arrays = {.count = cloud.points.size(),
               .positions = numbers(cloud.points.positions.data()),
               .origin = {},
               .intensities = data_or_null(cloud.intensities),
               .classes = data_or_null(cloud.classes),
               .colors = cloud.colors.empty() ? nullptr : cloud.colors.front().data(),
               .tree_ids = data_or_null(cloud.tree_ids)};
    copy(cloud.points.origin, arrays->origin);
    return COPPICE_OK;
}

coppice_status coppice_bytes_get(const coppice_object* object, const char** bytes, size_t* count) {
    const auto* text = find<std::string>(object);
    if (text == nullptr) return COPPICE_WRONG_USAGE;
    *bytes = text->c_str();
    *count = text->size();
    return COPPICE_OK;
}

size_t coppice_attribute_count(const coppice_object* object) {
    return visit_attribute(object, std::numeric_limits<std::size_t>::max(), [](const char*, const float*) {});
}

coppice_status coppice_attribute_get(const coppice_object* object, size_t index, const char** name,
                                     const float** values) {
    const std::size_t count =
        visit_attribute(object, index, [&](const char* its_name, const float* its_values) {
            *name = its_name;
            *values = its_values;
        });
    return index < count ? COPPICE_OK : COPPICE_WRONG_USAGE;
}

coppice_status coppice_skeleton_create(coppice_task* task, const coppice_nodes* nodes,
                                       coppice_object** skeleton) {
    return task->call([&] {
        coppice::SkeletonFile file = make_skeleton(*nodes);
        task->report = coppice::cli::figures_json({{"repairs", coppice::compute_figures(file.report)}});
        *skeleton = make_object(std::move(file));
        return coppice::cli::kDone;
    });
}

coppice_status coppice_surface_create(coppice_task* task, const coppice_faces* faces,
                                      coppice_object** surface) {
    return task->call([&] {
        *surface = make_object(make_surface(*faces));
        return coppice::cli::kDone;
    });
}

coppice_status coppice_points_create(coppice_task* task, size_t count, const double* positions,
                                     coppice_object** points) {
    return task->call([&] {
        coppice::PointFile file{.format = "memory"};
        coppice::PointSet& set = file.point_cloud.points;
        set.origin = copy_positions(positions, count, "point", set.positions);
        *points = make_object(std::move(file));
        return coppice::cli::kDone;
    });
}

coppice_status coppice_bytes_create(coppice_task* task, const char* bytes, size_t count,
                                    coppice_object** object) {
    return task->call([&] {
        *object = make_object(std::string(bytes, count));
        return coppice::cli::kDone;
    });
}
