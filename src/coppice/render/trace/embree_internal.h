#pragma once

#include <embree3/rtcore.h>

#include <cstddef>
#include <memory>
#include <new>
#include <span>

#include "coppice/base/context.h"
#include "coppice/base/vec.h"

namespace coppice {

template <class T, void (*release)(T)>
struct Release {
    using pointer = T;
    void operator()(T object) const { release(object); }
};
using EmbreeDevice = std::unique_ptr<RTCDevice, Release<RTCDevice, rtcReleaseDevice>>;
using EmbreeScene = std::unique_ptr<RTCScene, Release<RTCScene, rtcReleaseScene>>;
using EmbreeGeometry = std::unique_ptr<RTCGeometry, Release<RTCGeometry, rtcReleaseGeometry>>;

/// Throws Unsupported if the processor is too old.
EmbreeDevice new_embree_device(const Context& ctx);

/// Throws std::bad_alloc.
template <class T>
std::span<T> new_embree_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format,
                               std::size_t count) {
    void* data = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(T), count);
    if (data == nullptr) throw std::bad_alloc();
    return {static_cast<T*>(data), count};
}

/// Commits the geometry and attaches it to the scene, which then owns it.
void attach_geometry(RTCScene scene, RTCGeometry geometry);

/// Builds the tree of the scene; throws Cancelled, std::bad_alloc, Unsupported.
void commit_scene(RTCDevice device, RTCScene scene, const Context& ctx);

/// Returns the nearest hit of a ray; without a hit its hit.geomID is RTC_INVALID_GEOMETRY_ID.
RTCRayHit cast_ray(RTCScene scene, Vec3 origin, Vec3 direction);

}  // namespace coppice
