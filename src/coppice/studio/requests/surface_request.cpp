#include "coppice/scene/mesh_memory.h"
#include "coppice/studio/requests/surface_request_internal.h"

namespace coppice::studio_internal {

SurfaceRequest surface_request(const Request& request) {
    SurfaceRequest surface;
    surface.options.levels = 1;
    const auto found = request.fields.find("surface");
    if (found != request.fields.end()) from_json(*found, option_fields(surface.options), "surface");
    surface.text = to_json(option_fields(surface.options)).dump();
    return surface;
}

std::optional<std::uint64_t> get_known_version(const Request& request) {
    if (!request.fields.contains("have")) return std::nullopt;
    return request.count("have", 0);
}

const LiveSurfaces::Shown& follow(Studio& studio, const std::string& name, const ObjectPtr& object,
                                  const SurfaceRequest& surface, const Context& ctx) {
    studio.reserve(memory_of_mesh(std::get<Skeleton>(object->value), surface.options));
    return studio.surfaces.follow(name, object, surface.options, surface.text, ctx);
}

std::optional<std::string> encode_since(const LiveSurfaces::Shown& shown, std::optional<std::uint64_t> have,
                                        std::optional<std::uint64_t> seq, StudioColor color,
                                        const Context& ctx) {
    const GeometryHead head{ObjectKind::skeleton, shown.name, shown.number, seq};
    if (have && color == StudioColor::plain) {
        if (*have == shown.number) return std::nullopt;
        if (const auto change = LiveSurfaces::since(shown, *have))
            return encode_patch(shown.surface, *change, head, *have);
    }
    return encode_live_surface(shown.surface, *shown.object, head, color, ctx);
}

}  // namespace coppice::studio_internal
