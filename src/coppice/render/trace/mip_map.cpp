#include <algorithm>
#include <array>
#include <cmath>

#include "coppice/base/parallel.h"
#include "coppice/render/colors.h"
#include "coppice/render/trace/mip_map_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kRows = 16;  // of a level, processed as a unit

/// Texels of a line that a texel of the next level covers, with their weights, which sum to 1.
struct Cover {
    int first = 0, count = 0;
    std::array<float, 4> weight{};
};

/// Divides `from` texels into `to` equal parts: less than four texels each.
Cover cover(int from, int to, int index) {
    const double size = static_cast<double>(from) / to, begin = index * size, end = begin + size;
    Cover out;
    out.first = static_cast<int>(begin);
    for (int i = out.first; i < from && i < end && out.count < 4; ++i) {
        const double part = std::min(end, i + 1.0) - std::max(begin, double(i));
        out.weight[static_cast<std::size_t>(out.count++)] = static_cast<float>(part / size);
    }
    return out;
}

int wrapped(int i, int size) { return i < 0 ? i + size : i >= size ? i - size : i; }

/// Returns the first texel and the weight of the second for a coordinate in units of the texture.
struct Between {
    int first, second;
    float weight;
};
Between between(float coordinate, int size) {
    const float at = (coordinate - std::floor(coordinate)) * static_cast<float>(size) - 0.5f;
    const float low = std::floor(at);
    const int first = static_cast<int>(low);
    return {wrapped(first, size), wrapped(first + 1, size), at - low};
}

}  // namespace

MipMap::MipMap(const Image& image, TexelEncoding encoding, const Context& ctx) : image_(image) {
    for (int byte = 0; byte < 256; ++byte) {
        const auto b = static_cast<std::uint8_t>(byte);
        decoded_.push_back(encoding == TexelEncoding::srgb ? to_linear(Rgb{b, b, b}).x
                                                           : static_cast<float>(byte) / 255);
    }
    while (width(levels_.size()) > 1 || height(levels_.size()) > 1)
        levels_.push_back(halved(levels_.size(), ctx));
}

Vec3 MipMap::texel(std::size_t level, int x, int y) const {
    if (level > 0) {
        const Level& l = levels_[level - 1];
        return l.texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(l.width) +
                        static_cast<std::size_t>(x)];
    }
    const Image::Pixel& p = image_.at(x, y);
    return {decoded_[p[0]], decoded_[p[1]], decoded_[p[2]]};
}

MipMap::Level MipMap::halved(std::size_t level, const Context& ctx) const {
    Level out{std::max(1, width(level) / 2), std::max(1, height(level) / 2), {}};
    out.texels.resize(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
    std::vector<Cover> columns;
    for (int x = 0; x < out.width; ++x) columns.push_back(cover(width(level), out.width, x));
    parallel_for(ctx, static_cast<std::size_t>(out.height), kRows, [&](std::size_t row) {
        const Cover rows = cover(height(level), out.height, static_cast<int>(row));
        for (int x = 0; x < out.width; ++x) {
            const Cover& c = columns[static_cast<std::size_t>(x)];
            Vec3 sum;
            for (int j = 0; j < rows.count; ++j) {
                Vec3 line;
                for (int i = 0; i < c.count; ++i)
                    line += texel(level, c.first + i, rows.first + j) * c.weight[static_cast<std::size_t>(i)];
                sum += line * rows.weight[static_cast<std::size_t>(j)];
            }
            out.texels[row * static_cast<std::size_t>(out.width) + static_cast<std::size_t>(x)] = sum;
        }
    });
    return out;
}

Vec3 MipMap::bilinear(std::size_t level, float u, float v) const {
    const Between x = between(u, width(level)), y = between(-v, height(level));
    const Vec3 top = lerp(texel(level, x.first, y.first), texel(level, x.second, y.first), x.weight);
    const Vec3 bottom = lerp(texel(level, x.first, y.second), texel(level, x.second, y.second), x.weight);
    return lerp(top, bottom, y.weight);
}

Vec3 MipMap::sample(float u, float v, float level) const {
    const auto last = static_cast<float>(levels_.size());
    const float at = level > 0 ? std::min(level, last) : 0.0f;  // NaN is 0
    const float low = std::floor(at);
    const auto index = static_cast<std::size_t>(low);
    const Vec3 fine = bilinear(index, u, v);
    return at > low ? lerp(fine, bilinear(index + 1, u, v), at - low) : fine;
}

float MipMap::level(float du_dx, float dv_dx, float du_dy, float dv_dy) const {
    const auto w = static_cast<float>(image_.width), h = static_cast<float>(image_.height);
    const float longest = std::max(std::hypot(du_dx * w, dv_dx * h), std::hypot(du_dy * w, dv_dy * h));
    return std::log2(std::max(longest, 1e-6f));
}

bool is_cut_out(const Image& image, TexturePoint at) {
    constexpr float kHalf = 127.5f;
    const Between x = between(at.u, image.width), y = between(-at.v, image.height);
    const auto row = [&](int line) {
        const auto first = static_cast<float>(image.at(x.first, line)[3]);
        const auto second = static_cast<float>(image.at(x.second, line)[3]);
        return first + (second - first) * x.weight;
    };
    const float top = row(y.first), bottom = row(y.second);
    return top + (bottom - top) * y.weight < kHalf;
}

}  // namespace coppice
