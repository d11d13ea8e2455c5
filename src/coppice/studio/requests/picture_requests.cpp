#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "coppice/base/error.h"
#include "coppice/base/progress.h"
#include "coppice/render/png.h"
#include "coppice/scene/drawing.h"
#include "coppice/scene/words.h"
#include "coppice/studio/session_internal.h"
#include "coppice/system/file.h"

namespace coppice::studio_internal {
namespace {

constexpr double kNarrowestView = 1e-3, kWidestView = 170;  // [degrees]
constexpr double kFarthest = 1e7;                    // [m] maximum coordinate of the camera and its target
constexpr double kMinShown = 1e-6, kMaxShown = 1e7;  // [m] range of the height of an image
constexpr float kGathered = 0.1f;                    // of the time

Vec3d read_vector(const Json& camera, const char* field) {
    const auto found = camera.find(field);
    if (found == camera.end() || !found->is_array() || found->size() != 3)
        throw InvalidInput(fmt::format("the camera requires '{}' as [x, y, z]", field));
    const Vec3d out{found->at(0).get<double>(), found->at(1).get<double>(), found->at(2).get<double>()};
    if (!(std::abs(out.x) + std::abs(out.y) + std::abs(out.z) <= kFarthest))
        throw InvalidInput(fmt::format("'{}' of the camera is too far away", field));
    return out;
}

/// [pixels] per metre in the plane at distance 1, or in any plane for a parallel projection.
double compute_scale(const Json& camera, int height) {
    if (const auto parallel = camera.find("parallel"); parallel != camera.end()) {
        const double shown = parallel->get<double>();
        if (!(shown >= kMinShown && shown <= kMaxShown))
            throw InvalidInput(
                "'parallel' requires the metres that the image height shows, from 1e-6 to 1e7");
        return height / shown;
    }
    const auto found = camera.find("field_of_view");
    const double degrees = found == camera.end() ? 0 : found->get<double>();
    if (!(degrees >= kNarrowestView && degrees <= kWidestView))
        throw InvalidInput("the camera requires 'field_of_view' in degrees, or 'parallel' in metres");
    return 0.5 * height / std::tan(degrees * std::numbers::pi / 360);
}

/// Returns the camera of the page: x to the right, y down, z in viewing direction.
SketchView parse_view(const Json& camera, int width, int height) {
    const Vec3d eye = read_vector(camera, "eye"), ahead = read_vector(camera, "target") - eye;
    if (!(length(ahead) > 1e-9)) throw InvalidInput("the camera's 'target' must differ from its 'eye'");
    const Vec3d z = normalized(ahead);
    Vec3d up = camera.contains("up") ? read_vector(camera, "up") : Vec3d{0, 0, 1};
    if (!(length(cross(z, up)) > 1e-9 * length(up))) up = {0, 1, 0};
    if (!(length(cross(z, up)) > 1e-9)) up = {1, 0, 0};
    const Vec3d x = normalized(cross(z, up)), y = cross(z, x);
    const double scale = compute_scale(camera, height);
    SketchView view;
    view.width = width;
    view.height = height;
    if (camera.contains("parallel")) view.projection = Projection::orthographic;
    view.k = {{{scale, 0, 0.5 * width}, {0, scale, 0.5 * height}, {0, 0, 1}}};
    view.r = {{{x.x, x.y, x.z}, {y.x, y.y, y.z}, {z.x, z.y, z.z}}};
    view.t = Vec3d{} - view.r * eye;
    return view;
}

/// Returns the objects that the request lists, by name or by kind and name.
std::vector<Document::Name> read_names(const Request& request) {
    std::vector<Document::Name> out;
    for (const Json& object : request.fields.at("objects")) {
        const bool alone = object.is_string();
        const Request inner{request.client, alone ? request.fields : object, request.ctx};
        out.emplace_back(inner.kind(), alone ? object.get<std::string>() : inner.text("name"));
    }
    if (out.empty()) throw InvalidInput("the image requires 'objects' to show");
    return out;
}

/// Renders an image by the path tracer; trees are drawn by their surfaces, unless the request selects the
/// skeletons.
Json picture(Studio& studio, const Request& request) {
    const std::string& file = request.text("file");
    const std::filesystem::path path = path_to_write(studio, request, file);
    const std::vector<Document::Name> names = read_names(request);
    // The options are those of `render`, parsed and checked by the scene's own table.
    const std::string line =
        fmt::format("render {} {} kind={}{}", quoted_word(names.front().second), quoted_word(file),
                    name_of(names.front().first), typed_options(request, "options"));
    const Scene& scene = studio.document.scene();
    const Context gathering = narrow_progress(request.ctx, 0, kGathered),
                  drawing = narrow_progress(request.ctx, kGathered, 1);
    const SceneCall call = bind_command(scene_words(line), scene.state(), scene.settings(), gathering);
    const auto options = call.options<RenderOptions>("render");
    std::optional<SketchView> view;
    if (const auto camera = request.fields.find("camera"); camera != request.fields.end())
        view = parse_view(*camera, options.camera.width, options.camera.height);
    std::vector<ObjectPtr> objects;
    for (const Document::Name& name : names) {
        const bool as_it_is =
            name.first != ObjectKind::skeleton || request.text("as", "surface") == "skeleton";
        objects.push_back(as_it_is ? studio.object(name.first, name.second)
                                   : make_surface(studio, name, surface_options(request), gathering));
    }
    const Drawing drawn(objects, static_cast<float>(call.number("point_radius")), call);
    RenderScene shown = drawn.scene();
    if (view) shown.view = &*view;
    constexpr double kBytesOfPixel = 16;
    studio.reserve(kBytesOfPixel * options.camera.width * options.camera.height);
    write_file(path, encode_png(render(shown, options, drawing)));
    return written(path, file);
}

}  // namespace

std::map<std::string, Handler> picture_requests() { return {{"picture", picture}}; }

}  // namespace coppice::studio_internal
