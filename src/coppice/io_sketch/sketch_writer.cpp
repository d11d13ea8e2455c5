#include <nlohmann/json.hpp>

#include "coppice/io_sketch/sketch_file.h"
#include "coppice/options/json.h"
#include "coppice/system/file.h"

namespace coppice {
namespace {

Json make_json(const SketchView& view) {
    Json out{{"name", view.name}};
    if (!view.image.empty()) out["image"] = view.image;
    if (view.width > 0) out["width"] = view.width;
    if (view.height > 0) out["height"] = view.height;
    const bool orthographic = view.projection == Projection::orthographic;
    out["projection"] = orthographic ? "orthographic" : "perspective";
    out["K"] = view.k;
    out["R"] = view.r;
    out["t"] = {view.t.x, view.t.y, view.t.z};
    if (!orthographic && view.distortion != std::array<double, 5>{}) out["distortion"] = view.distortion;
    return out;
}

Json make_json(const Stroke& stroke) {
    Json points = Json::array();
    for (const PicturePoint p : stroke.points) points.push_back({p.x, p.y});
    Json out{{"points", std::move(points)}};
    if (!stroke.widths.empty()) out["widths"] = stroke.widths;
    return out;
}

Json make_json(const Sketch& sketch, const SketchBranch& branch) {
    Json out{{"name", branch.name}};
    if (branch.parent) out["parent"] = sketch.branches[*branch.parent].name;
    if (branch.attach) out["attach"] = *branch.attach;
    if (branch.diameters) out["diameters"] = *branch.diameters;
    Json strokes = Json::object();
    for (const Stroke& stroke : branch.strokes) strokes[sketch.views[stroke.view].name] = make_json(stroke);
    out["strokes"] = std::move(strokes);
    return out;
}

/// Writes one line for each view and branch, because people read and edit these files.
std::string join_lines(const std::vector<Json>& list) {
    std::string out = "[";
    for (std::size_t i = 0; i < list.size(); ++i) out += (i == 0 ? "\n" : ",\n") + list[i].dump();
    return out + "\n]";
}

}  // namespace

std::string encode_sketch(const Sketch& sketch) {
    std::vector<Json> views, branches;
    for (const SketchView& view : sketch.views) views.push_back(make_json(view));
    for (const SketchBranch& branch : sketch.branches) branches.push_back(make_json(sketch, branch));
    return "{\"format\": \"coppice-sketch\", \"version\": 1,\n\"views\": " + join_lines(views) +
           ",\n\"branches\": " + join_lines(branches) + "}\n";
}

void write_sketch(const std::filesystem::path& path, const Sketch& sketch) {
    write_file(path, encode_sketch(sketch));
}

}  // namespace coppice
