#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "coppice/base/vec.h"
#include "coppice/render/image.h"

namespace coppice::view_internal {

/// Throws Unsupported naming what was to be made when OpenGL reports an error, as that memory ran out.
void check_gl(const std::string& what);

/// A vertex array, bound.
class GlVertexArray {
  public:
    GlVertexArray();
    ~GlVertexArray();
    GlVertexArray(const GlVertexArray&) = delete;
    GlVertexArray& operator=(const GlVertexArray&) = delete;

  private:
    std::uint32_t name_ = 0;
};

/// What a buffer holds for each vertex: some floats.
struct GlAttribute {
    std::uint32_t location;  ///< in the vertex shader
    int floats;
};

/// A buffer object with its bytes, which may be an attribute of the vertices.
class GlBuffer {
  public:
    GlBuffer(std::uint32_t target, std::span<const std::byte> bytes,
             std::optional<GlAttribute> attribute = {});
    ~GlBuffer();
    GlBuffer(const GlBuffer&) = delete;
    GlBuffer& operator=(const GlBuffer&) = delete;

    std::uint32_t name() const { return name_; }

  private:
    std::uint32_t name_ = 0;
};

/// Two shaders, linked.
class GlProgram {
  public:
    GlProgram(const char* vertex_shader, const char* fragment_shader);
    ~GlProgram();
    GlProgram(const GlProgram&) = delete;
    GlProgram& operator=(const GlProgram&) = delete;

    void use() const;
    void set(const char* uniform, const std::array<float, 16>& columns) const;
    void set(const char* uniform, Vec3 value) const;

  private:
    std::uint32_t name_ = 0;
};

/// What is drawn on: a framebuffer with several samples a pixel, and one to which their means go.
class Canvas {
  public:
    /// With as many samples as there can be, up to those asked for.
    Canvas(int width, int height, int samples);
    ~Canvas();
    Canvas(const Canvas&) = delete;
    Canvas& operator=(const Canvas&) = delete;

    void begin() const;  ///< what is drawn from now on comes here
    void end() const;    ///< takes the means
    Image picture() const;

  private:
    int width_, height_;
    std::array<std::uint32_t, 2> frames_{};   ///< that is drawn on, with the means
    std::array<std::uint32_t, 3> buffers_{};  ///< colour, depth, colour of the means
};

}  // namespace coppice::view_internal
