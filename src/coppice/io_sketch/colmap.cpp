#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/io/text.h"
#include "coppice/io_sketch/colmap_internal.h"
#include "coppice/system/file.h"

namespace coppice {
namespace {

using Words = std::vector<std::string_view>;

double number_at(const Words& words, std::size_t i, const std::string& source, const LineReader& lines) {
    const auto number = i < words.size() ? parse_number(words[i]) : std::nullopt;
    if (number && std::isfinite(*number)) return *number;
    fail_at(
        source, lines.number(),
        i < words.size() ? fmt::format("{} is not a number", in_quotes(words[i])) : "a number is missing");
}

int pixels_at(const Words& words, std::size_t i, const std::string& source, const LineReader& lines) {
    constexpr std::int64_t kMaxPixels = 1'000'000;
    const auto number = i < words.size() ? parse_integer(words[i]) : std::nullopt;
    if (number && *number >= 1 && *number <= kMaxPixels) return static_cast<int>(*number);
    fail_at(source, lines.number(), "the width and height of a camera must be whole numbers of pixels");
}

/// Indices of the parameters of a camera model; -1: not in the model.
struct Model {
    std::string_view name;
    int fx, fy, cx, cy, k1, k2, p1, p2, k3;
    int count;  ///< number of parameters; those without an index must be 0
};
constexpr Model kModels[] = {{"SIMPLE_PINHOLE", 0, 0, 1, 2, -1, -1, -1, -1, -1, 3},
                             {"PINHOLE", 0, 1, 2, 3, -1, -1, -1, -1, -1, 4},
                             {"SIMPLE_RADIAL", 0, 0, 1, 2, 3, -1, -1, -1, -1, 4},
                             {"RADIAL", 0, 0, 1, 2, 3, 4, -1, -1, -1, 5},
                             {"OPENCV", 0, 1, 2, 3, 4, 5, 6, 7, -1, 8},
                             {"FULL_OPENCV", 0, 1, 2, 3, 4, 5, 6, 7, 8, 12}};

/// Reads the intrinsic parameters: CAMERA_ID MODEL WIDTH HEIGHT PARAMS...
void read_camera(const Words& words, const std::string& source, const LineReader& lines, SketchView& view) {
    const auto model = std::ranges::find(kModels, words.size() > 1 ? words[1] : "", &Model::name);
    if (model == std::end(kModels)) {
        throw Unsupported(fmt::format(
            "{}:{}: the camera model {} is not read; undistort the images with COLMAP, which writes PINHOLE",
            source, lines.number(), in_quotes(words.size() > 1 ? words[1] : "")));
    }
    std::vector<double> p;
    for (int i = 0; i < model->count; ++i)
        p.push_back(number_at(words, 4 + static_cast<std::size_t>(i), source, lines));
    const auto at = [&](int i) { return i < 0 ? 0 : p[static_cast<std::size_t>(i)]; };
    for (std::size_t i = 9; i < p.size(); ++i) {
        if (p[i] != 0)
            throw Unsupported(
                fmt::format("{}:{}: k4, k5 and k6 of FULL_OPENCV are not read", source, lines.number()));
    }
    view.width = pixels_at(words, 2, source, lines);
    view.height = pixels_at(words, 3, source, lines);
    view.k = {{{at(model->fx), 0, at(model->cx)}, {0, at(model->fy), at(model->cy)}, {0, 0, 1}}};
    view.distortion = {at(model->k1), at(model->k2), at(model->p1), at(model->p2), at(model->k3)};
}

}  // namespace

SketchView read_colmap_view(const std::filesystem::path& folder, const std::string& image) {
    const std::filesystem::path images = folder / "images.txt", cameras = folder / "cameras.txt";
    SketchView view;
    std::string camera;
    Words words;
    const std::string image_text = read_file(images);
    LineReader lines(image_text);
    // Every image has two lines; the second one contains its points, and may be empty.
    for (bool second = false; lines.next();) {
        if (!lines.line().empty() && lines.line().front() == '#') continue;
        if (std::exchange(second, !second)) continue;
        split_at_blanks(lines.line(), words);
        if (words.size() < 10 || words[9] != image) continue;
        const auto number = [&](std::size_t i) { return number_at(words, i, images.string(), lines); };
        view.r = compute_rotation(number(1), {number(2), number(3), number(4)});
        view.t = {number(5), number(6), number(7)};
        camera = words[8];
        break;
    }
    if (camera.empty())
        throw InvalidInput(fmt::format("{}: no image is named {}", images.string(), in_quotes(image)));
    const std::string camera_text = read_file(cameras);
    for (LineReader rows(camera_text); rows.next();) {
        split_at_blanks(rows.line(), words);
        if (words.empty() || words[0] != camera) continue;
        read_camera(words, cameras.string(), rows, view);
        return view;
    }
    throw InvalidInput(
        fmt::format("{}: there is no camera {}, which took {}", cameras.string(), camera, in_quotes(image)));
}

}  // namespace coppice
