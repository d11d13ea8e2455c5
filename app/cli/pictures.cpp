#include "pictures.h"

#include <fmt/format.h>

#include "coppice/render/contact_sheet.h"
#include "coppice/render/png.h"
#include "coppice/render/png_reader.h"
#include "coppice/render/render.h"
#include "coppice/scene/bark_images.h"
#include "coppice/system/file.h"
#include "files.h"
#include "options.h"

namespace coppice::cli {

std::vector<Image> draw_each(Run& run, std::span<const Skeleton* const> trees, int size) {
    constexpr int kSamples = 8;
    const RenderOptions options{
        .camera = {.width = size, .height = size}, .samples = kSamples, .ground = false};
    return run.stage("draw", [&](const Context& ctx) {
        std::vector<Image> out;
        const Context each{.threads = ctx.threads, .stop = ctx.stop};
        for (const Skeleton* tree : trees) {
            out.push_back(render({.skeleton = tree}, options, each));
            ctx.report(static_cast<float>(out.size()) / static_cast<float>(trees.size()));
        }
        return out;
    });
}

void check_picture_output(const std::filesystem::path& path) {
    if (path.empty()) return;
    if (!is_png_name(path))
        throw UsageError(
            fmt::format("'{}' is not the name of an image; use the extension .png", path.string()));
    check_output_folder(path);
}

std::filesystem::path height_file(const std::filesystem::path& prefix) {
    return make_bark_file_name(prefix.string(), "height");
}

std::optional<TileSize> load_tile_size(const std::filesystem::path& image) {
    return read_tile_size(read_file(image, kLargestFile));
}

HeightTexture load_heights(Run& run, const std::filesystem::path& prefix, float scale) {
    const std::string name = height_file(prefix).string();
    std::error_code error;
    if (!std::filesystem::exists(name, error))
        throw IoError(fmt::format("there is no file {}; write it by coppice texture", name));
    return run.stage("read heights", [&](const Context& ctx) {
        HeightTexture heights = decode_height_png(read_file(name, kLargestFile, ctx), name);
        if (scale == 0 && heights.scale == 0)
            throw InvalidInput(
                fmt::format("{}: the file has no scale of its heights; give --displace-height", name));
        return heights;
    });
}

void write_picture(const std::filesystem::path& path, const Image& image) {
    write_file(path, encode_png(image));
}

void write_sheet(const std::filesystem::path& path, std::span<const Image> pictures) {
    write_picture(path, contact_sheet(pictures));
}

}  // namespace coppice::cli
