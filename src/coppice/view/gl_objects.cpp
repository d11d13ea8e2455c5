#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>

#include "coppice/base/error.h"
#include "coppice/view/gl_objects_internal.h"

namespace coppice::view_internal {
namespace {

constexpr GLsizei kLongestMessage = 512;

std::uint32_t compiled(GLenum kind, const char* source) {
    const GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    GLint is_done = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &is_done);
    if (is_done != 0) return shader;
    std::array<char, kLongestMessage> message{};
    glGetShaderInfoLog(shader, kLongestMessage, nullptr, message.data());
    glDeleteShader(shader);
    throw Unsupported(fmt::format("the OpenGL driver does not compile a shader: {}", message.data()));
}

// A renderbuffer attached to the current framebuffer.
void attach(GLuint buffer, GLenum format, GLenum place, int samples, int width, int height) {
    glBindRenderbuffer(GL_RENDERBUFFER, buffer);
    if (samples > 1) {
        glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
    } else {
        glRenderbufferStorage(GL_RENDERBUFFER, format, width, height);
    }
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, place, GL_RENDERBUFFER, buffer);
}

void check_frame(int width, int height) {
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE) return;
    throw Unsupported(fmt::format("OpenGL cannot draw an image of {} x {} pixels here; choose a smaller one",
                                  width, height));
}

}  // namespace

void check_gl(const std::string& subject) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) return;
    throw Unsupported(error == GL_OUT_OF_MEMORY
                          ? fmt::format("{} is too large for the memory of the OpenGL device", subject)
                          : fmt::format("the OpenGL driver refuses {} (error {:#06x})", subject, error));
}

GlVertexArray::GlVertexArray() {
    glGenVertexArrays(1, &name_);
    glBindVertexArray(name_);
}
GlVertexArray::~GlVertexArray() { glDeleteVertexArrays(1, &name_); }

GlBuffer::GlBuffer(std::uint32_t target, std::span<const std::byte> bytes,
                   std::optional<GlAttribute> attribute) {
    glGenBuffers(1, &name_);
    glBindBuffer(target, name_);
    glBufferData(target, static_cast<GLsizeiptr>(bytes.size()), bytes.data(),
                 attribute ? GL_DYNAMIC_DRAW : GL_STATIC_DRAW);
    if (!attribute) return;
    glVertexAttribPointer(attribute->location, attribute->floats, GL_FLOAT, GL_FALSE, 0, nullptr);
    glEnableVertexAttribArray(attribute->location);
}
GlBuffer::~GlBuffer() { glDeleteBuffers(1, &name_); }

GlProgram::GlProgram(const char* vertex_shader, const char* fragment_shader) : name_(glCreateProgram()) {
    for (const GLuint shader :
         {compiled(GL_VERTEX_SHADER, vertex_shader), compiled(GL_FRAGMENT_SHADER, fragment_shader)}) {
        glAttachShader(name_, shader);
        glDeleteShader(shader);
    }
    glLinkProgram(name_);
    GLint is_done = 0;
    glGetProgramiv(name_, GL_LINK_STATUS, &is_done);
    if (is_done == 0) throw Unsupported("the OpenGL driver does not link two shaders");
}
GlProgram::~GlProgram() { glDeleteProgram(name_); }

void GlProgram::use() const { glUseProgram(name_); }
void GlProgram::set(const char* uniform, const std::array<float, 16>& columns) const {
    glUniformMatrix4fv(glGetUniformLocation(name_, uniform), 1, GL_FALSE, columns.data());
}
void GlProgram::set(const char* uniform, Vec3 value) const {
    glUniform3f(glGetUniformLocation(name_, uniform), value.x, value.y, value.z);
}

Canvas::Canvas(int width, int height, int samples) : width_(width), height_(height) {
    GLint max_samples = 1, largest = 0;
    glGetIntegerv(GL_MAX_SAMPLES, &max_samples);
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
    if (std::max(width, height) > largest)
        throw Unsupported(fmt::format(
            "OpenGL draws images of at most {} x {} pixels here; choose a smaller one", largest, largest));
    const int taken = std::min(samples, max_samples);
    glGenFramebuffers(2, frames_.data());
    glGenRenderbuffers(3, buffers_.data());
    glBindFramebuffer(GL_FRAMEBUFFER, frames_[1]);
    attach(buffers_[2], GL_RGBA8, GL_COLOR_ATTACHMENT0, 1, width, height);
    check_frame(width, height);
    glBindFramebuffer(GL_FRAMEBUFFER, frames_[0]);
    attach(buffers_[0], GL_RGBA8, GL_COLOR_ATTACHMENT0, taken, width, height);
    attach(buffers_[1], GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT, taken, width, height);
    check_frame(width, height);
    check_gl("the image");
}

Canvas::~Canvas() {
    glDeleteFramebuffers(2, frames_.data());
    glDeleteRenderbuffers(3, buffers_.data());
}

void Canvas::begin() const {
    glBindFramebuffer(GL_FRAMEBUFFER, frames_[0]);
    glViewport(0, 0, width_, height_);
}

void Canvas::end() const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, frames_[0]);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, frames_[1]);
    glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

Image Canvas::picture() const {
    Image upside_down(width_, height_), out(width_, height_);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, frames_[1]);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, upside_down.pixels.data());
    check_gl("the image");
    for (int y = 0; y < height_; ++y) std::copy_n(&upside_down.at(0, height_ - 1 - y), width_, &out.at(0, y));
    return out;
}

}  // namespace coppice::view_internal
