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

/// Throws Unsupported with the name of the object if OpenGL reports an error, for example exhausted memory.
void check_gl(const std::string& subject);

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

/// The data of a buffer for each vertex: a number of floats.
struct GlAttribute {
    std::uint32_t location;  ///< location in the vertex shader
    int floats;
};

/// A buffer object with its data, which may be a vertex attribute.
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

/// A program of two linked shaders.
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

/// The target of drawing: a framebuffer with several samples per pixel, and one for their means.
class Canvas {
  public:
    /// Uses the maximum supported number of samples up to the requested one.
    Canvas(int width, int height, int samples);
    ~Canvas();
    Canvas(const Canvas&) = delete;
    Canvas& operator=(const Canvas&) = delete;

    void begin() const;  ///< binds the target
    void end() const;    ///< resolves the samples to their means
    Image picture() const;

  private:
    int width_, height_;
    std::array<std::uint32_t, 2> frames_{};   ///< multisampled target, and means
    std::array<std::uint32_t, 3> buffers_{};  ///< colour, depth, colour of the means
};

}  // namespace coppice::view_internal
