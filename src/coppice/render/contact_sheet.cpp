#include "coppice/render/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "coppice/base/error.h"

namespace coppice {

Image contact_sheet(std::span<const Image> pictures, int columns) {
    constexpr std::int64_t kMaxPixels = 128'000'000;
    if (pictures.empty()) throw InvalidInput("contact sheet: there are no images");
    const int width = pictures[0].width, height = pictures[0].height;
    const auto count = static_cast<int>(pictures.size());
    if (columns <= 0) columns = static_cast<int>(std::ceil(std::sqrt(count)));
    columns = std::min(columns, count);
    const int rows = (count + columns - 1) / columns;
    if (std::int64_t{columns} * width * rows * height > kMaxPixels)
        throw InvalidInput("contact sheet: the images are too many or too large for one sheet");
    Image out(columns * width, rows * height);
    std::ranges::fill(out.pixels, Image::Pixel{255, 255, 255, 255});
    for (int i = 0; i < count; ++i) {
        const Image& picture = pictures[static_cast<std::size_t>(i)];
        if (picture.width != width || picture.height != height)
            throw InvalidInput("contact sheet: the images differ in size");
        const int left = i % columns * width, top = i / columns * height;
        for (int y = 0; y < height; ++y) {
            const auto row = std::span(picture.pixels)
                                 .subspan(static_cast<std::size_t>(y) * static_cast<std::size_t>(width));
            std::copy_n(row.begin(), width, &out.at(left, top + y));
        }
    }
    return out;
}

}  // namespace coppice
