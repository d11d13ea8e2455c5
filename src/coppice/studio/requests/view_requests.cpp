#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/scene/mesh_memory.h"
#include "coppice/scene/script/statements.h"
#include "coppice/scene/words.h"
#include "coppice/studio/requests/surface_request_internal.h"
#include "coppice/studio/show/slice_internal.h"

namespace coppice::studio_internal {
namespace {

constexpr int kFineCells = 56;  // along the longest side of a solid

StudioColor get_color(const Request& request) {
    const std::string name = request.text("color", "plain");
    const auto found = std::ranges::find(EnumNames<StudioColor>::names, name);
    if (found == EnumNames<StudioColor>::names.end())
        throw InvalidInput(fmt::format(
            "'{}' is not a colouring; use plain, radius, order, deviation or evidence", name.substr(0, 40)));
    return static_cast<StudioColor>(found - EnumNames<StudioColor>::names.begin());
}

Json show_surface(Studio& studio, const Request& request, const ObjectPtr& object) {
    const std::string& name = request.text("name");
    const LiveSurfaces::Shown& shown = follow(studio, name, object, surface_request(request), request.ctx);
    auto blob = encode_since(shown, get_known_version(request), {}, get_color(request), request.ctx);
    Json out{{"number", shown.number}, {"key", nullptr}};
    if (blob) out["key"] = studio.blobs.offer(std::move(*blob));
    return out;
}

/// Offers the geometry of an object, which is computed on request as long as the object exists.
template <class Make>
Json offer(Studio& studio, const std::string& key, const ObjectPtr& object, const Make& make) {
    studio.blobs.offer(key, [of = std::weak_ptr(object), make]() -> std::optional<std::string> {
        const ObjectPtr there = of.lock();
        if (!there) return std::nullopt;
        return make(*there);
    });
    return {{"key", key}};
}

MeshOptions cage_options() {
    MeshOptions options;
    options.levels = 0;
    return options;
}

/// The control cage: the surface before subdivision.
std::string encode_cage(const Skeleton& tree, const GeometryHead& head) {
    MeshResult result = mesh_skeleton(tree, cage_options(), {});
    Surface cage;
    std::visit([&](auto& made) { cage.mesh = std::move(made.mesh); }, result.surface);
    const SceneObject object{std::move(cage), 0};
    return encode_object(object, head, kCoarseCells, StudioColor::plain, {});
}

Json show(Studio& studio, const Request& request) {
    const ObjectKind kind = request.kind();
    const std::string& name = request.text("name");
    const ObjectPtr object = studio.object(kind, name);
    const std::string form = request.text("form", "coarse");
    if (kind == ObjectKind::skeleton && form == "surface") return show_surface(studio, request, object);
    studio.check_size(object->bytes, name);  // the geometry needs about as much memory as the object
    const StudioColor color = get_color(request);
    const GeometryHead head{kind, name, studio.notes.of(object).version, {}};
    const std::string key = fmt::format("{}-{}-{}", head.version, form, name_of(color));
    if (kind == ObjectKind::skeleton && form == "cage") {
        studio.reserve(memory_of_mesh(std::get<Skeleton>(object->value), cage_options()));
        return offer(studio, key, object, [head](const SceneObject& tree) {
            return encode_cage(std::get<Skeleton>(tree.value), head);
        });
    }
    const int cells = form == "fine" ? kFineCells : kCoarseCells;
    return offer(studio, key, object,
                 [=](const SceneObject& shown) { return encode_object(shown, head, cells, color, {}); });
}

/// Samples the field of a solid in a plane.
Json slice(Studio& studio, const Request& request) {
    if (request.kind() != ObjectKind::solid) throw InvalidInput("only solids have a field to slice");
    const std::string& name = request.text("name");
    const ObjectPtr object = studio.object(ObjectKind::solid, name);
    SliceOptions options;
    const std::string& axis = request.text("axis");
    const auto found = std::ranges::find(EnumNames<SliceAxis>::names, axis);
    if (found == EnumNames<SliceAxis>::names.end())
        throw InvalidInput(fmt::format("'{}' is not an axis; use x, y or z", axis.substr(0, 40)));
    options.axis = static_cast<SliceAxis>(found - EnumNames<SliceAxis>::names.begin());
    options.at = request.number("at");
    options.size = static_cast<int>(request.count("size", static_cast<std::size_t>(options.size)));
    check_slice(options);
    studio.check_size(sizeof(float) * static_cast<std::uint64_t>(options.size * options.size),
                      "a slice of " + name);
    const GeometryHead head{ObjectKind::solid, name, studio.notes.of(object).version, {}};
    const std::string key = fmt::format("{}-slice-{}-{}-{}", head.version, axis, options.at, options.size);
    return offer(studio, key, object, [=](const SceneObject& shown) {
        return encode_slice(std::get<Solid>(shown.value), options, head, {});
    });
}

/// Returns the result of a line without storing it: for images of seeds next to each other.
Json trial(Studio& studio, const Request& request) {
    const ObjectKind kind = request.kind();
    const std::string& name = request.text("name");
    const std::string form = request.text("form", "coarse");
    const bool surface = kind == ObjectKind::skeleton && form == "surface";
    Scene scene = studio.document.scene();
    scene.forbid_outputs();
    const std::string message = run_section(scene, request.text("line"), 1, "trial", request.ctx);
    if (surface)
        scene.run(fmt::format("mesh {0} {0}{1}", quoted_word(name), surface_options(request)), {},
                  request.ctx);
    const auto found = scene.state().objects.find({surface ? ObjectKind::mesh : kind, name});
    if (found == scene.state().objects.end())
        throw InvalidInput(fmt::format("the line creates no {} '{}'", name_of(kind), name.substr(0, 80)));
    const GeometryHead head{kind, name, studio.notes.of(found->second).version, {}};
    const int cells = form == "fine" ? kFineCells : kCoarseCells;
    return {{"message", message},
            {"key", studio.blobs.offer(
                        encode_object(*found->second, head, cells, get_color(request), request.ctx))}};
}

}  // namespace

std::map<std::string, Handler> view_requests() {
    return {{"show", show}, {"slice", slice}, {"trial", trial}};
}

}  // namespace coppice::studio_internal
