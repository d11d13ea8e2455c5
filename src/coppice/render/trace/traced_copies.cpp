#include "coppice/render/trace/traced_copies_internal.h"

#include <algorithm>
#include <limits>

namespace coppice {
namespace {

TracedMesh make_mesh(const Prototype& prototype, std::span<const RenderMaterial> materials, bool flat) {
    PolygonMesh mesh = to_polygons(prototype.mesh);
    mesh.texture.assign(prototype.texture.begin(), prototype.texture.end());
    mesh.texture.resize(mesh.corners.size(), TexturePoint{});
    const std::vector<std::uint32_t> face_materials(mesh.face_count(), prototype.material);
    TracedMesh out;
    out.set_faces(mesh, {mesh.positions.begin(), mesh.positions.end()});
    out.set_texture(mesh, face_materials, materials);
    if (!flat) out.smooth_normals();
    return out;
}

Box3 find_enlarged_box(std::span<const Vec3> positions) {
    constexpr float kMargin = 1e-4f;  // of the diagonal, above the rounding of rays
    Box3 box;
    for (const Vec3 p : positions) box.extend(p);
    return box.inflated(kMargin * box.diagonal());
}

/// Returns whether the part of a ray between two distances meets a box. A coordinate that does not change
/// along the ray at the border of the box gives NaN, which the comparisons ignore.
bool meets(const Box3& box, Vec3 origin, Vec3 direction, float near, float far) {
    for (int axis = 0; axis < 3; ++axis) {
        const float a = (box.low[axis] - origin[axis]) / direction[axis];
        const float b = (box.high[axis] - origin[axis]) / direction[axis];
        near = std::max(near, std::min(a, b));
        far = std::min(far, std::max(a, b));
    }
    return near <= far;
}

}  // namespace

TracedCopies::TracedCopies(std::span<const Prototype> prototypes, std::span<const RenderMaterial> materials,
                           const Instances& instances, std::span<const Vec3> positions, float unit, bool flat,
                           RTCDevice device, const Context& ctx)
    : instances_(instances) {
    places_.reserve(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        places_.push_back(
            {positions[i], instances.scales[i] * unit, instances.rotations[i], instances.prototypes[i]});
    }
    meshes_.reserve(prototypes.size());  // Embree refers to the meshes
    for (const Prototype& prototype : prototypes) {
        meshes_.push_back(make_mesh(prototype, materials, flat));
        boxes_.push_back(find_enlarged_box(prototype.mesh.positions));
        EmbreeScene scene(rtcNewScene(device));
        const TracedMesh& mesh = meshes_.back();
        attach_geometry(scene.get(), mesh.make_geometry(device, mesh.quads(), ctx).get());
        commit_scene(device, scene.get(), ctx);
        scenes_.push_back(std::move(scene));
    }
}

void TracedCopies::attach(RTCScene scene, RTCDevice device) const {
    const EmbreeGeometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER));
    rtcSetGeometryUserPrimitiveCount(geometry.get(), static_cast<unsigned>(places_.size()));
    rtcSetGeometryUserData(geometry.get(), const_cast<TracedCopies*>(this));
    rtcSetGeometryBoundsFunction(geometry.get(), find_box, nullptr);
    rtcSetGeometryIntersectFunction(geometry.get(), intersect);
    rtcSetGeometryOccludedFunction(geometry.get(), occlude);
    attach_geometry(scene, geometry.get());
}

TexturePlaces TracedCopies::texture_places(std::uint32_t copy, const FacePlace& place) const {
    TexturePlaces out = *prototype(copy).texture_places(place);
    for (Vec3* gradient : {&out.first.gradient_u, &out.first.gradient_v})
        *gradient = turned(copy, *gradient) / places_[copy].scale;
    return out;
}

void TracedCopies::find_box(const RTCBoundsFunctionArguments* args) {
    const auto& copies = *static_cast<const TracedCopies*>(args->geometryUserPtr);
    const Place& place = copies.places_[args->primID];
    Box3 box;
    for (const Vec3 p : copies.meshes_[place.prototype].positions())
        box.extend(place.position + rotate(place.rotation, p) * place.scale);
    RTCBounds& out = *args->bounds_o;
    out.lower_x = box.low.x, out.lower_y = box.low.y, out.lower_z = box.low.z;
    out.upper_x = box.high.x, out.upper_y = box.high.y, out.upper_z = box.high.z;
}

bool TracedCopies::localize(RTCRay& ray, const Place& place) const {
    const Quaternion r = place.rotation;
    const Quaternion back{-r.x, -r.y, -r.z, r.w};
    const float size = 1 / place.scale;
    const Vec3 origin = rotate(back, Vec3{ray.org_x, ray.org_y, ray.org_z} - place.position) * size;
    const Vec3 direction = rotate(back, Vec3{ray.dir_x, ray.dir_y, ray.dir_z}) * size;
    ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
    ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
    return meets(boxes_[place.prototype], origin, direction, ray.tnear, ray.tfar);
}

void TracedCopies::intersect(const RTCIntersectFunctionNArguments* args) {
    if (args->valid[0] == 0) return;  // one ray, as all calls trace single rays
    const auto& copies = *static_cast<const TracedCopies*>(args->geometryUserPtr);
    auto& ray = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    const Place& place = copies.places_[args->primID];
    RTCRayHit local;
    local.ray = ray.ray;
    if (!copies.localize(local.ray, place)) return;
    local.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(copies.scenes_[place.prototype].get(), &context, &local);
    if (local.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
    ray.ray.tfar = local.ray.tfar;
    ray.hit = local.hit;
    ray.hit.geomID = args->geomID;
    ray.hit.instID[0] = args->primID;
}

void TracedCopies::occlude(const RTCOccludedFunctionNArguments* args) {
    if (args->valid[0] == 0) return;
    const auto& copies = *static_cast<const TracedCopies*>(args->geometryUserPtr);
    auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
    const Place& place = copies.places_[args->primID];
    RTCRay local = ray;
    if (!copies.localize(local, place)) return;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(copies.scenes_[place.prototype].get(), &context, &local);
    if (local.tfar < 0) ray.tfar = -std::numeric_limits<float>::infinity();
}

}  // namespace coppice
