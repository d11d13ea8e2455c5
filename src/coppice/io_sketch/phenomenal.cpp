#include "coppice/io_sketch/phenomenal_internal.h"

#include "coppice/io_sketch/json_value_internal.h"
#include "coppice/system/file.h"

namespace coppice {

using namespace io_internal;

SketchView read_phenomenal_view(const std::filesystem::path& path, const std::string& camera, double angle) {
    const std::string source = path.string();
    const SortedJson json = parse_json(read_file(path), source);
    const Value file(json, source + ":"), cameras = file.member("cameras_parameters");
    std::string known;
    for (const auto& [name, value] : cameras.members()) known += (known.empty() ? "" : ", ") + name;
    if (!cameras.has(camera)) cameras.fail(fmt::format("has no {}; there are {}", in_quotes(camera), known));
    const Value its = cameras.member(camera);
    const auto number = [&](const char* name) { return its.member(name).number(); };
    SketchView view;
    view.width = its.member("_width_image").pixels();
    view.height = its.member("_height_image").pixels();
    view.k = {{{number("_focal_length_x"), 0, 0.5 * view.width},
               {0, number("_focal_length_y"), 0.5 * view.height},
               {0, 0, 1}}};
    // The axes of the camera in the world are Rz Ry Rx; a clockwise rotation of the table rotates the world
    // with it.
    const bool clockwise = file.has("clockwise") && file.member("clockwise").truth();
    const double turn = angle * file.member("angle_factor").number() * (clockwise ? -1 : 1);
    const Matrix3 axes = rotation_about({0, 0, number("_rot_z")}) * rotation_about({0, number("_rot_y"), 0}) *
                         rotation_about({number("_rot_x"), 0, 0});
    const Matrix3 to_camera = transposed(axes);
    view.r = to_camera * rotation_about({0, 0, turn});
    view.t = -(to_camera * Vec3d{number("_pos_x"), number("_pos_y"), number("_pos_z")}) * 1e-3;
    return view;
}

}  // namespace coppice
