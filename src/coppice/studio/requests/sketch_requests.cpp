#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "coppice/base/error.h"
#include "coppice/io_sketch/sketch_file.h"
#include "coppice/render/picture.h"
#include "coppice/render/silhouette.h"
#include "coppice/sketch/reconstruct.h"
#include "coppice/sketch/trace/trace.h"
#include "coppice/studio/session_internal.h"
#include "coppice/system/file.h"

namespace coppice::studio_internal {
namespace {

constexpr int kLinePoints = 64;     // number of points of an epipolar line
constexpr double kNearest = 1e-2;   // [m] minimum distance from the camera
constexpr double kFarthest = 1e4;   // [m] maximum distance
constexpr double kMaxPixels = 1e5;  // limit outside the image, beyond which no strokes are drawn

std::string sketch_text(const Request& request) {
    const auto found = request.fields.find("sketch");
    if (found == request.fields.end() || !found->is_object())
        throw InvalidInput("the request requires a 'sketch' in the format of .sketch.json");
    return found->dump();
}

Json make_json(const Sketch& sketch, const BranchFit& fit) {
    Json strokes = Json::array();
    for (const StrokeFit& stroke : fit.strokes) {
        strokes.push_back({{"view", sketch.views[stroke.view].name},
                           {"points", stroke.points},
                           {"left_out", stroke.left_out},
                           {"reversed", stroke.reversed},
                           {"rms_error_pixels", stroke.rms_error},
                           {"max_error_pixels", stroke.max_error}});
    }
    return {{"name", sketch.branches[fit.branch].name},
            {"refused", fit.refused},
            {"angle_degrees", fit.angle * 180 / std::numbers::pi},
            {"matched", fit.matched},
            {"length_m", fit.length},
            {"guessed_radius", fit.guessed_radius},
            {"strokes", strokes}};
}

Json sketch(Studio& studio, const Request& request) {
    const Sketch drawn = parse_sketch(sketch_text(request), "sketch", studio.sandbox());
    SketchOptions options;
    if (const auto found = request.fields.find("options"); found != request.fields.end())
        from_json(*found, option_fields(options), "options");
    SketchResult result = reconstruct(drawn, options, "sketch", request.ctx);
    Json branches = Json::array();
    for (const BranchFit& fit : result.branches) branches.push_back(make_json(drawn, fit));
    const SceneObject object{std::move(result.skeleton), 0};
    const GeometryHead head{ObjectKind::skeleton, "sketch", 0, {}};
    return {{"key", studio.blobs.offer(encode_object(object, head, 1, StudioColor::plain, request.ctx))},
            {"branches", branches}};
}

/// Proposes strokes from the images that the views name.
Json trace_pictures(Studio& studio, const Request& request) {
    const SketchCameras cameras = parse_cameras(sketch_text(request), "sketch", studio.sandbox());
    std::vector<Mask> silhouettes;
    for (const SketchView& view : cameras.views) {
        if (view.image.empty())
            throw InvalidInput(fmt::format("the view '{}' has no image to trace", view.name));
        const std::string bytes = read_file(studio.sandbox().to_read(view.image), kLargestFile, request.ctx);
        silhouettes.push_back(compute_silhouette(decode_picture(bytes, view.image)));
    }
    const TraceResult result = trace_views(cameras, silhouettes, "sketch", request.ctx);
    return {{"sketch", Json::parse(encode_sketch(result.sketch))}, {"tips", result.tips}};
}

std::uint32_t view_called(const std::vector<SketchView>& views, const std::string& name) {
    for (std::uint32_t v = 0; v < views.size(); ++v) {
        if (views[v].name == name) return v;
    }
    throw InvalidInput(fmt::format("the sketch has no view '{}'", name.substr(0, 80)));
}

/// Returns the epipolar line in another image for a point in one image.
Json epipolar(Studio& studio, const Request& request) {
    const Sketch drawn = parse_sketch(sketch_text(request), "sketch", studio.sandbox());
    const SketchView& from = drawn.views[view_called(drawn.views, request.text("view"))];
    const SketchView& other = drawn.views[view_called(drawn.views, request.text("other"))];
    const Json& point = request.fields.at("point");
    const ViewRay sight = ray(from, {point.at(0).get<double>(), point.at(1).get<double>()});
    const bool flat = from.projection == Projection::orthographic;
    Json line = Json::array();
    for (int i = 0; i <= kLinePoints; ++i) {
        const double t = static_cast<double>(i) / kLinePoints;
        // Logarithmic steps from a camera; the rays of a drawing have no start.
        const double distance =
            flat ? (2 * t - 1) * kFarthest / 100 : kNearest * std::pow(kFarthest / kNearest, t);
        const Vec3d at = sight.origin + sight.direction * distance;
        if (other.projection == Projection::perspective && depth(other, at) <= kNearest) continue;
        const PicturePoint p = project(other, at);
        if (std::abs(p.x) < kMaxPixels && std::abs(p.y) < kMaxPixels) line.push_back({p.x, p.y});
    }
    return {{"line", line}};
}

}  // namespace

std::map<std::string, Handler> sketch_requests() {
    return {{"sketch", sketch}, {"trace", trace_pictures}, {"epipolar", epipolar}};
}

}  // namespace coppice::studio_internal
