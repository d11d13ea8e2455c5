#include "coppice/render/gif.h"

#include <gtest/gtest.h>

#include <vector>

#include "coppice/base/error.h"

namespace coppice {
namespace {

/// Decodes the output of GifEncoder, written from the specification of the format and not from the encoder.
class Gif {
  public:
    explicit Gif(const std::string& bytes) : bytes_(bytes.begin(), bytes.end()) {
        EXPECT_EQ(bytes.substr(0, 6), "GIF89a");
        width = word(6);
        height = word(8);
        at_ = 13 + 3 * 256 + 19;
        while (bytes_[at_] != ';') read_picture();
    }
    unsigned width = 0, height = 0;
    std::vector<std::vector<int>> pictures;  ///< the displayed colours of all pixels
    std::vector<unsigned> delays;

  private:
    unsigned word(std::size_t at) const { return bytes_[at] + 256u * bytes_[at + 1]; }
    int color(unsigned i) const {
        const std::size_t at = 13 + 3 * std::size_t{i};
        return bytes_[at] << 16 | bytes_[at + 1] << 8 | bytes_[at + 2];
    }
    void read_picture() {
        ASSERT_EQ(bytes_[at_], 0x21);
        ASSERT_EQ(bytes_[at_ + 1], 0xf9);
        delays.push_back(word(at_ + 4));
        const unsigned transparent = bytes_[at_ + 6];
        at_ += 8;
        ASSERT_EQ(bytes_[at_], ',');
        at_ += 10;
        ASSERT_EQ(bytes_[at_++], 8);
        std::vector<unsigned char> data;
        for (std::size_t size; (size = bytes_[at_++]) != 0; at_ += size)
            data.insert(data.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                        bytes_.begin() + static_cast<std::ptrdiff_t>(at_ + size));
        std::vector<int> picture = pictures.empty() ? std::vector<int>(width * height) : pictures.back();
        const std::vector<unsigned> indices = decoded(data);
        ASSERT_EQ(indices.size(), picture.size());
        for (std::size_t i = 0; i < picture.size(); ++i) {
            if (indices[i] != transparent) picture[i] = color(indices[i]);
        }
        pictures.push_back(std::move(picture));
    }
    static std::vector<unsigned> decoded(const std::vector<unsigned char>& data) {
        std::vector<std::vector<unsigned>> table;
        std::vector<unsigned> out, last;
        unsigned bits = 9, have = 0, held = 0;
        const auto clear = [&] {
            table.clear();
            for (unsigned i = 0; i < 258; ++i) table.push_back({i});
            bits = 9;
            last.clear();
        };
        clear();
        for (const unsigned char byte : data) {
            held |= static_cast<unsigned>(byte) << have;
            have += 8;
            if (have < bits) continue;
            const unsigned code = held & ((1u << bits) - 1);
            held >>= bits;
            have -= bits;
            if (code == 257) return out;
            if (code == 256) {
                clear();
                continue;
            }
            std::vector<unsigned> now = code < table.size() ? table[code] : last;
            if (code >= table.size()) now.push_back(last.front());
            if (!last.empty() && table.size() < 4096) {
                last.push_back(now.front());
                table.push_back(last);
            }
            if (table.size() == 1u << bits && bits < 12) ++bits;
            out.insert(out.end(), now.begin(), now.end());
            last = std::move(now);
        }
        return out;
    }
    std::vector<unsigned char> bytes_;
    std::size_t at_ = 0;
};

Image pattern(int width, int height, unsigned step) {
    Image image(width, height);
    unsigned x = step;
    for (auto& p : image.pixels) {
        x = x * 1664525u + 1013904223u;
        const auto shade = static_cast<std::uint8_t>((x >> 28) * 16);
        p = {shade, static_cast<std::uint8_t>(shade / 2), 0, 255};
    }
    return image;
}

TEST(Gif, ImagesRoundTrip) {
    const std::vector<Image> images{pattern(160, 120, 1), pattern(160, 120, 2), pattern(160, 120, 2)};
    GifEncoder encoder(images[0], 0.04);
    std::string bytes = encoder.head();
    for (const Image& i : images) bytes += encoder.add(i);
    const Gif gif(bytes + GifEncoder::tail());
    EXPECT_EQ(gif.width, 160u);
    ASSERT_EQ(gif.pictures.size(), 3u);
    EXPECT_EQ(gif.delays, (std::vector<unsigned>{4, 4, 4}));
    for (std::size_t k = 0; k < images.size(); ++k) {
        for (std::size_t i = 0; i < images[k].pixels.size(); ++i) {
            const auto& p = images[k].pixels[i];
            ASSERT_EQ(gif.pictures[k][i], p[0] << 16 | p[1] << 8 | p[2]) << k << " " << i;
        }
    }
}

TEST(Gif, StoresOnlyChanges) {
    const Image image = pattern(200, 200, 3);
    GifEncoder encoder(image, 0.1);
    const std::size_t first = encoder.add(image).size();
    EXPECT_LT(encoder.add(image).size(), first / 20);
}

TEST(Gif, IsSmallerWithFewerColors) {
    const Image image = pattern(100, 100, 3);
    GifEncoder all(image, 0.1), few(image, 0.1, 4);
    EXPECT_LT(few.add(image).size(), all.add(image).size() / 2 + 100);
}

TEST(Gif, RejectsOtherSizes) {
    GifEncoder encoder(pattern(8, 8, 1), 0.1);
    EXPECT_THROW(encoder.add(pattern(9, 8, 1)), InvalidInput);
    EXPECT_THROW(GifEncoder(Image{}, 0.1), InvalidInput);
    EXPECT_THROW(GifEncoder(pattern(8, 8, 1), 0.1, 1), InvalidInput);
}

}  // namespace
}  // namespace coppice
