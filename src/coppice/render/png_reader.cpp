#include "coppice/render/height_png.h"

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

/// Reads the header, then the samples. The library reports an error by a jump: no object with a destructor is
/// created in between.
class HeightReader {
  public:
    explicit HeightReader(std::string_view bytes) : bytes_(bytes) {
        png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, fail, ignore);
        if (png_ != nullptr) info_ = png_create_info_struct(png_);
        if (info_ == nullptr) {
            png_destroy_read_struct(&png_, nullptr, nullptr);
            throw std::bad_alloc();
        }
        png_set_read_fn(png_, this, take);
    }
    ~HeightReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
    HeightReader(const HeightReader&) = delete;
    HeightReader& operator=(const HeightReader&) = delete;

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
        double slope = 0;
        const char* const end = parameters[1] + std::strlen(parameters[1]);
        if (std::from_chars(parameters[1], end, slope).ec != std::errc()) return 0;
        const double scale = slope * 65535 / (static_cast<double>(last) - static_cast<double>(first));
        return scale > 0 && scale <= kMaxHeightScale ? static_cast<float>(scale) : 0.0f;
    }
    const char* message() const { return message_; }

  private:
    [[noreturn]] static void fail(png_structp png, png_const_charp message) {
        auto* reader = static_cast<HeightReader*>(png_get_error_ptr(png));
        std::strncpy(reader->message_, message, sizeof reader->message_ - 1);
        png_longjmp(png, 1);
    }
    static void ignore(png_structp, png_const_charp) {}
    static void take(png_structp png, png_bytep out, std::size_t size) {
        auto* reader = static_cast<HeightReader*>(png_get_io_ptr(png));
        if (size > reader->bytes_.size()) png_error(png, "the file ends too early");
        std::memcpy(out, reader->bytes_.data(), size);
        reader->bytes_.remove_prefix(size);
    }

    std::string_view bytes_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
    char message_[128] = "";
};

}  // namespace

HeightTexture decode_height_png(std::string_view bytes, const std::string& name) {
    if (!bytes.starts_with("\x89PNG")) throw InvalidInput(name + ": this is not a PNG image");
    HeightReader reader(bytes);
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

}  // namespace coppice
