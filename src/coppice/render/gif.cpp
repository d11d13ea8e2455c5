#include "coppice/render/gif.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/error.h"

namespace coppice {
namespace {

constexpr int kMaxColors = 255;
constexpr std::uint8_t kUnchanged = 255;  // index of pixels that do not change from the previous image
constexpr int kCodeSize = 8;              // [bits] of a palette of 256
constexpr std::uint32_t kClear = 1u << kCodeSize, kEnd = kClear + 1, kMaxCodes = 4096;

std::uint32_t find_bin(const Image::Pixel& p) {
    return static_cast<std::uint32_t>(p[0] >> 3) << 10 | static_cast<std::uint32_t>(p[1] >> 3) << 5 |
           p[2] >> 3;
}

/// Pixels of similar colour.
struct Bin {
    std::array<double, 3> color{};  ///< mean
    double count = 0;
};

std::vector<Bin> histogram(const Image& image) {
    std::vector<Bin> bins(1u << 15);
    for (const Image::Pixel& p : image.pixels) {
        Bin& bin = bins[find_bin(p)];
        ++bin.count;
        for (std::size_t k = 0; k < 3; ++k) bin.color[k] += p[k];
    }
    std::erase_if(bins, [](const Bin& b) { return b.count == 0; });
    for (Bin& bin : bins) {
        for (double& c : bin.color) c /= bin.count;
    }
    return bins;
}

Bin mean(const std::vector<Bin>& box) {
    Bin out;
    for (const Bin& b : box) {
        out.count += b.count;
        for (std::size_t k = 0; k < 3; ++k) out.color[k] += b.count * b.color[k];
    }
    for (double& c : out.color) c /= out.count;
    return out;
}

/// Returns the channel of largest variance, with that variance times the number of pixels.
std::pair<double, std::size_t> spread(const std::vector<Bin>& box) {
    const Bin middle = mean(box);
    std::pair<double, std::size_t> out{-1, 0};
    for (std::size_t k = 0; k < 3; ++k) {
        double sum = 0;
        for (const Bin& b : box)
            sum += b.count * (b.color[k] - middle.color[k]) * (b.color[k] - middle.color[k]);
        if (sum > out.first) out = {sum, k};
    }
    return out;
}

/// Splits the box of widest spread at its mean, until there are as many boxes as colours.
std::vector<std::array<std::uint8_t, 3>> compute_palette(const Image& image, std::size_t count) {
    std::vector<std::vector<Bin>> boxes{histogram(image)};
    std::vector<std::pair<double, std::size_t>> spreads{spread(boxes[0])};
    while (boxes.size() < count) {
        const auto widest = static_cast<std::size_t>(std::ranges::max_element(spreads) - spreads.begin());
        const std::size_t channel = spreads[widest].second;
        if (!(spreads[widest].first > 0)) break;
        const double at = mean(boxes[widest]).color[channel];
        std::vector<Bin>& low = boxes[widest];
        const auto middle = std::stable_partition(low.begin(), low.end(),
                                                  [&](const Bin& b) { return b.color[channel] <= at; });
        std::vector<Bin> high(middle, low.end());
        low.erase(middle, low.end());
        if (high.empty() || low.empty()) {
            low.insert(low.end(), high.begin(), high.end());
            spreads[widest].first = 0;  // cannot be split because of rounding
            continue;
        }
        spreads[widest] = spread(low);
        spreads.push_back(spread(high));
        boxes.push_back(std::move(high));
    }
    std::vector<std::array<std::uint8_t, 3>> colors;
    for (const auto& box : boxes) {
        const Bin b = mean(box);
        colors.push_back({static_cast<std::uint8_t>(std::lround(b.color[0])),
                          static_cast<std::uint8_t>(std::lround(b.color[1])),
                          static_cast<std::uint8_t>(std::lround(b.color[2]))});
    }
    return colors;
}

void put_word(std::string& out, unsigned value) {
    out += static_cast<char>(value & 255);
    out += static_cast<char>(value >> 8 & 255);
}

/// Writes codes of increasing width in blocks of 255 bytes.
class CodeWriter {
  public:
    void put(std::uint32_t code, int bits) {
        held_ |= std::uint64_t{code} << count_;
        count_ += bits;
        for (; count_ >= 8; count_ -= 8, held_ >>= 8) bytes_ += static_cast<char>(held_ & 255);
    }
    std::string finish() {
        if (count_ > 0) bytes_ += static_cast<char>(held_ & 255);
        constexpr std::size_t kBlock = 255;
        std::string out;
        for (std::size_t i = 0; i < bytes_.size(); i += kBlock) {
            const std::size_t size = std::min(kBlock, bytes_.size() - i);
            out += static_cast<char>(size);
            out.append(bytes_, i, size);
        }
        return out + '\0';
    }

  private:
    std::string bytes_;
    std::uint64_t held_ = 0;
    int count_ = 0;
};

/// LZW compression as defined by GIF.
std::string compressed(const std::vector<std::uint8_t>& pixels) {
    CodeWriter out;
    std::vector<std::uint16_t> next(std::size_t{kMaxCodes} << kCodeSize,
                                    0);  // by code and byte; 0: undefined
    std::uint32_t free = kEnd + 1;
    int bits = kCodeSize + 1;
    out.put(kClear, bits);
    std::uint32_t code = pixels.front();
    for (std::size_t i = 1; i < pixels.size(); ++i) {
        std::uint16_t& longer = next[std::size_t{code} << kCodeSize | pixels[i]];
        if (longer != 0) {
            code = longer;
            continue;
        }
        out.put(code, bits);
        if (free == kMaxCodes) {
            out.put(kClear, bits);
            std::ranges::fill(next, std::uint16_t{0});
            free = kEnd + 1;
            bits = kCodeSize + 1;
        } else {
            longer = static_cast<std::uint16_t>(free);
            if (free == 1u << bits) ++bits;
            ++free;
        }
        code = pixels[i];
    }
    out.put(code, bits);
    out.put(kEnd, bits);
    return out.finish();
}

}  // namespace

GifEncoder::GifEncoder(const Image& first, double delay, int colors)
    : width_(first.width),
      height_(first.height),
      delay_(static_cast<unsigned>(std::clamp(std::lround(100 * delay), 2L, 65535L))),
      nearest_(1u << 15, -1) {
    if (first.pixels.empty()) throw InvalidInput("a GIF requires images with pixels");
    if (width_ > 65535 || height_ > 65535)
        throw InvalidInput("a GIF is limited to 65,535 pixels of width and height");
    if (colors < 2 || colors > kMaxColors) throw InvalidInput("a GIF requires 2 to 255 colours");
    colors_ = compute_palette(first, static_cast<std::size_t>(colors));
}

std::string GifEncoder::head() const {
    std::string out = "GIF89a";
    put_word(out, static_cast<unsigned>(width_));
    put_word(out, static_cast<unsigned>(height_));
    out += '\xf7';  // a palette of 256 colours
    out.append(2, '\0');
    for (std::size_t i = 0; i < 256; ++i) {
        for (std::size_t k = 0; k < 3; ++k) out += static_cast<char>(i < colors_.size() ? colors_[i][k] : 0);
    }
    return out + std::string("\x21\xff\x0bNETSCAPE2.0\x03\x01\x00\x00\x00", 19);
}

std::uint8_t GifEncoder::index_of(const Image::Pixel& pixel) {
    std::int16_t& known = nearest_[find_bin(pixel)];
    if (known >= 0) return static_cast<std::uint8_t>(known);
    int least = std::numeric_limits<int>::max();
    for (std::size_t i = 0; i < colors_.size(); ++i) {
        int sum = 0;
        for (std::size_t k = 0; k < 3; ++k) sum += (pixel[k] - colors_[i][k]) * (pixel[k] - colors_[i][k]);
        if (sum >= least) continue;
        least = sum;
        known = static_cast<std::int16_t>(i);
    }
    return static_cast<std::uint8_t>(known);
}

std::string GifEncoder::add(const Image& picture) {
    if (picture.width != width_ || picture.height != height_)
        throw InvalidInput("the images of a GIF must have the same size");
    std::vector<std::uint8_t> now, shown;
    now.reserve(picture.pixels.size());
    for (const Image::Pixel& p : picture.pixels) now.push_back(index_of(p));
    shown = now;
    for (std::size_t i = 0; i < last_.size(); ++i) {
        if (now[i] == last_[i]) shown[i] = kUnchanged;
    }
    last_ = std::move(now);
    std::string out("\x21\xf9\x04\x05", 4);  // no disposal; one index is transparent
    put_word(out, delay_);
    out += static_cast<char>(kUnchanged);
    out += '\0';
    out += ',';
    out.append(4, '\0');
    put_word(out, static_cast<unsigned>(width_));
    put_word(out, static_cast<unsigned>(height_));
    out += '\0';
    out += static_cast<char>(kCodeSize);
    return out + compressed(shown);
}

}  // namespace coppice
