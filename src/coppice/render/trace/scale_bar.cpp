#include "coppice/render/trace/scale_bar_internal.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "coppice/render/colors.h"

namespace coppice {
namespace {

constexpr std::string_view kLetters = "0123456789.+-% mkun";
constexpr int kGlyphWidth = 5, kGlyphHeight = 7;
// One row of five dots per entry, most significant bit left.
constexpr std::array<std::array<std::uint8_t, kGlyphHeight>, kLetters.size()> kGlyphs{{
    {0b01110, 0b10001, 0b10001, 0b10001, 0b10001, 0b10001, 0b01110},
    {0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110},
    {0b01110, 0b10001, 0b00001, 0b00110, 0b01000, 0b10000, 0b11111},
    {0b01110, 0b10001, 0b00001, 0b00110, 0b00001, 0b10001, 0b01110},
    {0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010},
    {0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110},
    {0b00110, 0b01000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110},
    {0b11111, 0b00001, 0b00010, 0b00100, 0b01000, 0b01000, 0b01000},
    {0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110},
    {0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00010, 0b01100},
    {0b00000, 0b00000, 0b00000, 0b00000, 0b00000, 0b00110, 0b00110},
    {0b00000, 0b00100, 0b00100, 0b11111, 0b00100, 0b00100, 0b00000},
    {0b00000, 0b00000, 0b00000, 0b11111, 0b00000, 0b00000, 0b00000},
    {0b11001, 0b11001, 0b00010, 0b00100, 0b01000, 0b10011, 0b10011},
    {0b00000, 0b00000, 0b00000, 0b00000, 0b00000, 0b00000, 0b00000},
    {0b00000, 0b00000, 0b11010, 0b10101, 0b10101, 0b10101, 0b10101},
    {0b10000, 0b10000, 0b10010, 0b10100, 0b11000, 0b10100, 0b10010},
    {0b00000, 0b00000, 0b10001, 0b10001, 0b10001, 0b10011, 0b01101},
    {0b00000, 0b00000, 0b10110, 0b11001, 0b10001, 0b10001, 0b10001},
}};

constexpr Image::Pixel kInk{40, 42, 46, 255};

void fill(Image& image, int left, int top, int width, int height, Image::Pixel color) {
    for (int y = std::max(0, top); y < std::min(image.height, top + height); ++y) {
        for (int x = std::max(0, left); x < std::min(image.width, left + width); ++x) image.at(x, y) = color;
    }
}

void draw_text(Image& image, std::string_view text, int left, int top, int dot) {
    for (const char c : text) {
        const auto& glyph = kGlyphs[kLetters.find(c)];
        for (int row = 0; row < kGlyphHeight; ++row) {
            for (int column = 0; column < kGlyphWidth; ++column) {
                if (glyph[static_cast<std::size_t>(row)] >> (kGlyphWidth - 1 - column) & 1) {
                    fill(image, left + column * dot, top + row * dot, dot, dot, kInk);
                }
            }
        }
        left += (kGlyphWidth + 1) * dot;
    }
}

Image::Pixel encoded(Vec3 linear) {
    const auto [red, green, blue] = to_srgb(linear);
    return {red, green, blue, 255};
}

}  // namespace

std::string length_text(double length) {
    struct Scale {
        double metres;
        std::string_view name;
    };
    static constexpr std::array<Scale, 5> kScales{
        {{1e3, "km"}, {1, "m"}, {1e-3, "mm"}, {1e-6, "um"}, {1e-9, "nm"}}};
    const auto* scale = kScales.begin();
    // A value that rounds up to 1000 belongs to the next unit.
    while (scale + 1 != kScales.end() && length < 0.9995 * scale->metres) ++scale;
    const double number = length / scale->metres;
    return fmt::format("{:.{}f} {}", number, number < 9.995 ? 2 : number < 99.95 ? 1 : 0, scale->name);
}

ScaleLabels around_zero(const std::string& number) { return {"+" + number, "0", "-" + number}; }

void draw_scale_bar(Image& image, const ScaleLabels& labels) {
    const int dot = std::max(1, std::min(image.width, image.height) / 400);
    const std::size_t longest = std::max({labels.top.size(), labels.middle.size(), labels.bottom.size()});
    const int text_width = static_cast<int>(longest) * (kGlyphWidth + 1) * dot;
    const int bar_width = 10 * dot, bar_height = image.height / 3, gap = 4 * dot;
    const int left = image.width - text_width - gap - bar_width - 2 * gap,
              top = (image.height - bar_height) / 2;
    if (left < image.width / 3 || bar_height < 5 * kGlyphHeight * dot) return;

    fill(image, left - dot, top - dot, bar_width + 2 * dot, bar_height + 2 * dot, kInk);
    for (int y = 0; y < bar_height; ++y) {
        const float t = 1 - 2 * (static_cast<float>(y) + 0.5f) / static_cast<float>(bar_height);
        fill(image, left, top + y, bar_width, 1, encoded(deviation_color(t)));
    }
    const int text_left = left + bar_width + gap, rise = kGlyphHeight * dot / 2;
    draw_text(image, labels.top, text_left, top - rise, dot);
    draw_text(image, labels.middle, text_left, top + bar_height / 2 - rise, dot);
    draw_text(image, labels.bottom, text_left, top + bar_height - rise, dot);
}

}  // namespace coppice
