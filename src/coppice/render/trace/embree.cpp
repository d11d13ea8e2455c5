#include <fmt/format.h>

#include <limits>

#include "coppice/base/error.h"
#include "coppice/render/trace/embree_internal.h"

namespace coppice {

EmbreeDevice new_embree_device(const Context& ctx) {
    const auto config = fmt::format("threads={}", ctx.threads);
    EmbreeDevice device(rtcNewDevice(config.c_str()));
    if (!device && rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    if (!device) throw Unsupported("the ray tracer does not run on this processor (Embree requires SSE2)");
    return device;
}

void attach_geometry(RTCScene scene, RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
}

void commit_scene(RTCDevice device, RTCScene scene, const Context& ctx) {
    const auto go_on = [](void* context, double) {
        return !static_cast<const Context*>(context)->stop.stop_requested();
    };
    rtcSetSceneProgressMonitorFunction(scene, go_on, const_cast<Context*>(&ctx));
    rtcCommitScene(scene);
    rtcSetSceneProgressMonitorFunction(scene, nullptr, nullptr);
    const RTCError code = rtcGetDeviceError(device);
    if (code == RTC_ERROR_NONE) return;
    ctx.throw_if_cancelled();
    if (code == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    throw Unsupported(
        fmt::format("the ray tracer cannot use this scene (Embree error {})", static_cast<int>(code)));
}

RTCRayHit cast_ray(RTCScene scene, Vec3 origin, Vec3 direction) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit r{};
    r.ray.org_x = origin.x, r.ray.org_y = origin.y, r.ray.org_z = origin.z;
    r.ray.dir_x = direction.x, r.ray.dir_y = direction.y, r.ray.dir_z = direction.z;
    r.ray.tfar = std::numeric_limits<float>::infinity();
    r.ray.mask = ~0u;
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &r);
    return r;
}

}  // namespace coppice
