#include "coppice/render/picture.h"

#include <fmt/format.h>
// jpeglib.h needs the types of stdio.h first.
#include <cstdio>

#include <jpeglib.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>

#include "coppice/base/error.h"

namespace coppice {
namespace {

constexpr std::uint64_t kMaxPixels = 128'000'000;

void check_size(std::uint64_t width, std::uint64_t height, const std::string& name) {
    if (width * height <= kMaxPixels) return;
    throw InvalidInput(
        fmt::format("{}: {} x {} pixels are more than {} million; reduce the size of the image", name, width,
                    height, kMaxPixels / 1'000'000));
}

Image decode_png(std::string_view bytes, const std::string& name) {
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    const auto damaged = [&] {
        return InvalidInput(fmt::format("{}: this PNG is damaged: {}", name, header.message));
    };
    if (!png_image_begin_read_from_memory(&header, bytes.data(), bytes.size())) throw damaged();
    struct Freed {
        png_image& header;
        ~Freed() { png_image_free(&header); }
    } const freed{header};
    check_size(header.width, header.height, name);
    header.format = PNG_FORMAT_RGBA;
    Image image(static_cast<int>(header.width), static_cast<int>(header.height));
    if (!png_image_finish_read(&header, nullptr, image.pixels.data(), 0, nullptr)) throw damaged();
    return image;
}

/// libjpeg returns through longjmp: no object with a destructor may be created between setjmp and longjmp.
struct JpegReader {
    jpeg_decompress_struct state{};
    jpeg_error_mgr errors{};
    std::jmp_buf failed{};
    char message[JMSG_LENGTH_MAX] = "";

    static JpegReader& of(j_common_ptr state) { return *static_cast<JpegReader*>(state->client_data); }
    [[noreturn]] static void fail(j_common_ptr state) {
        state->err->format_message(state, of(state).message);
        std::longjmp(of(state).failed, 1);
    }
    static void pass_over(j_common_ptr, int) {}

    explicit JpegReader(std::string_view bytes) {
        state.err = jpeg_std_error(&errors);
        state.client_data = this;
        errors.error_exit = fail;
        errors.emit_message = pass_over;
        data_ = reinterpret_cast<const unsigned char*>(bytes.data());
        size_ = bytes.size();
    }
    ~JpegReader() { jpeg_destroy_decompress(&state); }
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;

    bool begin() {
        if (setjmp(failed) != 0) return false;
        jpeg_create_decompress(&state);
        jpeg_mem_src(&state, data_, size_);
        jpeg_read_header(&state, TRUE);
        state.out_color_space = JCS_RGB;
        return true;
    }
    /// Fills width * height * 3 bytes.
    bool read(unsigned char* rgb) {
        if (setjmp(failed) != 0) return false;
        jpeg_start_decompress(&state);
        while (state.output_scanline < state.output_height) {
            JSAMPROW row = rgb + std::size_t{3} * state.output_scanline * state.output_width;
            jpeg_read_scanlines(&state, &row, 1);
        }
        jpeg_finish_decompress(&state);
        return true;
    }

  private:
    const unsigned char* data_ = nullptr;
    unsigned long size_ = 0;
};

Image decode_jpeg(std::string_view bytes, const std::string& name) {
    JpegReader reader(bytes);
    const auto damaged = [&] {
        return InvalidInput(fmt::format("{}: this JPEG is damaged: {}", name, reader.message));
    };
    if (!reader.begin()) throw damaged();
    check_size(reader.state.image_width, reader.state.image_height, name);
    Image image(static_cast<int>(reader.state.image_width), static_cast<int>(reader.state.image_height));
    std::vector<unsigned char> rgb(3 * image.pixels.size());
    if (!reader.read(rgb.data())) throw damaged();
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = {rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2], 255};
    return image;
}

}  // namespace

Image decode_picture(std::string_view bytes, const std::string& name) {
    if (bytes.starts_with("\x89PNG")) return decode_png(bytes, name);
    if (bytes.starts_with("\xff\xd8")) return decode_jpeg(bytes, name);
    throw InvalidInput(name + ": this is neither a PNG nor a JPEG image");
}

Image overlay(const Image& picture, const Image& drawn, float opacity) {
    if (picture.width != drawn.width || picture.height != drawn.height) {
        throw InvalidInput(
            fmt::format("a drawing of {} x {} pixels cannot be placed over an image of {} x {}", drawn.width,
                        drawn.height, picture.width, picture.height));
    }
    Image out = picture;
    for (std::size_t i = 0; i < out.pixels.size(); ++i) {
        const float cover = opacity * static_cast<float>(drawn.pixels[i][3]) / 255;
        for (std::size_t c = 0; c < 4; ++c) {
            const auto below = static_cast<float>(out.pixels[i][c]);
            const float above = c == 3 ? 255.0f : static_cast<float>(drawn.pixels[i][c]);
            out.pixels[i][c] = static_cast<std::uint8_t>(std::lround(std::lerp(below, above, cover)));
        }
    }
    return out;
}

}  // namespace coppice
