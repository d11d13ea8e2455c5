#include "coppice/render/png_reader.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <new>

#include "coppice/base/error.h"

namespace coppice {
namespace {

constexpr std::uint64_t kMaxHeights = std::uint64_t{1} << 26;
constexpr double kMaxHeightScale = 1e3;  // [m]

/// Returns 0 for other text than a number.
double to_number(std::string_view text) {
    double out = 0;
    std::from_chars(text.data(), text.data() + text.size(), out);
    return out;
}

/// Returns the extent [m] of pixels of the given extent; 0 if it is out of range.
float to_extent(std::string_view pixel, std::uint32_t pixels) {
    constexpr double kMin = 1e-3, kMax = 1e3;  // [m]
    const double extent = to_number(pixel) * pixels;
    return extent >= kMin && extent <= kMax ? static_cast<float>(extent) : 0.0f;
}

/// Reads the header, then the samples. The library reports an error by a jump: no object with a destructor is
/// created in between.
class PngReader {
  public:
    explicit PngReader(std::string_view bytes) : bytes_(bytes) {
        png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, fail, ignore);
        if (png_ != nullptr) info_ = png_create_info_struct(png_);
        if (info_ == nullptr) {
            png_destroy_read_struct(&png_, nullptr, nullptr);
            throw std::bad_alloc();
        }
        png_set_read_fn(png_, this, take);
    }
    ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    bool read_header() {
        if (setjmp(png_jmpbuf(png_)) != 0) return false;
        png_read_info(png_, info_);
        return true;
    }
    bool read_samples(std::uint16_t* samples) {
        if (setjmp(png_jmpbuf(png_)) != 0) return false;
        if (std::endian::native == std::endian::little) png_set_swap(png_);
        const int passes = png_set_interlace_handling(png_);
        for (int pass = 0; pass < passes; ++pass) {
            for (std::uint32_t row = 0; row < height(); ++row)
                png_read_row(png_, reinterpret_cast<png_bytep>(samples + std::size_t{row} * width()),
                             nullptr);
        }
        png_read_end(png_, nullptr);
        return true;
    }

    std::uint32_t width() const { return png_get_image_width(png_, info_); }
    std::uint32_t height() const { return png_get_image_height(png_, info_); }
    bool is_grey_16() const {
        return png_get_color_type(png_, info_) == PNG_COLOR_TYPE_GRAY && png_get_bit_depth(png_, info_) == 16;
    }
    /// Returns 0 if there is no valid scale in metres.
    float scale() const {
        char *purpose = nullptr, *units = nullptr, **parameters = nullptr;
        png_int_32 first = 0, last = 0;
        int equation = 0, count = 0;
        if (png_get_pCAL(png_, info_, &purpose, &first, &last, &equation, &count, &units, &parameters) == 0)
            return 0;
        if (equation != PNG_EQUATION_LINEAR || count != 2 || std::string_view(units) != "m" || first == last)
            return 0;
        const double range = static_cast<double>(last) - static_cast<double>(first);
        const double scale = to_number(parameters[1]) * 65535 / range;
        return scale > 0 && scale <= kMaxHeightScale ? static_cast<float>(scale) : 0.0f;
    }
    /// Returns nullopt if there is no valid extent in metres.
    std::optional<TileSize> tile_size() const {
        int unit = 0;
        char *pixel_width = nullptr, *pixel_height = nullptr;
        if (png_get_sCAL_s(png_, info_, &unit, &pixel_width, &pixel_height) == 0) return std::nullopt;
        if (unit != PNG_SCALE_METER) return std::nullopt;
        const TileSize out{to_extent(pixel_width, width()), to_extent(pixel_height, height())};
        if (out.width == 0 || out.height == 0) return std::nullopt;
        return out;
    }
    const char* message() const { return message_; }

  private:
    [[noreturn]] static void fail(png_structp png, png_const_charp message) {
        auto* reader = static_cast<PngReader*>(png_get_error_ptr(png));
        std::strncpy(reader->message_, message, sizeof reader->message_ - 1);
        png_longjmp(png, 1);
    }
    static void ignore(png_structp, png_const_charp) {}
    static void take(png_structp png, png_bytep out, std::size_t size) {
        auto* reader = static_cast<PngReader*>(png_get_io_ptr(png));
        if (size > reader->bytes_.size()) png_error(png, "the file ends too early");
        std::memcpy(out, reader->bytes_.data(), size);
        reader->bytes_.remove_prefix(size);
    }

    std::string_view bytes_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
    char message_[128] = "";
};

bool is_png(std::string_view bytes) { return bytes.starts_with("\x89PNG"); }

}  // namespace

HeightTexture decode_height_png(std::string_view bytes, const std::string& name) {
    if (!is_png(bytes)) throw InvalidInput(name + ": this is not a PNG image");
    PngReader reader(bytes);
    const auto damaged = [&] {
        return InvalidInput(fmt::format("{}: this PNG is damaged: {}", name, reader.message()));
    };
    if (!reader.read_header()) throw damaged();
    if (!reader.is_grey_16())
        throw InvalidInput(name + ": heights need a grey PNG of 16 bits, as coppice texture writes it");
    const std::uint64_t pixels = std::uint64_t{reader.width()} * reader.height();
    if (pixels > kMaxHeights) {
        throw InvalidInput(fmt::format("{}: {} x {} pixels are more than {}; reduce the size of the image",
                                       name, reader.width(), reader.height(), kMaxHeights));
    }
    HeightTexture out{
        static_cast<int>(reader.width()), static_cast<int>(reader.height()), reader.scale(), {}};
    out.heights.resize(pixels);
    if (!reader.read_samples(out.heights.data())) throw damaged();
    return out;
}

std::optional<TileSize> read_tile_size(std::string_view bytes) {
    if (!is_png(bytes)) return std::nullopt;
    PngReader reader(bytes);
    reader.read_header();  // chunks before a damaged one are valid
    return reader.tile_size();
}

}  // namespace coppice
