#include "coppice/view/surface_view.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "coppice/base/error.h"
#include "coppice/view/gl_objects_internal.h"

namespace coppice {
namespace {

using view_internal::Canvas;
using view_internal::GlAttribute;
using view_internal::GlBuffer;
using view_internal::GlProgram;

constexpr const char* kVertexShader = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float marked;
uniform mat4 to_clip;
out vec3 shown_normal;
out float shown_mark;
void main() {
    shown_normal = normal;
    shown_mark = marked;
    gl_Position = to_clip * vec4(position, 1.0);
}
)";

// Light is summed linearly and encoded as sRGB at the end, as in the images of render().
constexpr const char* kFragmentShader = R"(#version 330 core
in vec3 shown_normal;
in float shown_mark;
uniform vec3 to_sun;
uniform vec3 to_camera;
out vec4 color;
const vec3 wood = vec3(0.285, 0.215, 0.155);
const vec3 fresh_wood = vec3(0.36, 0.185, 0.095);
const vec3 sky = vec3(0.60, 0.70, 0.86);
const vec3 ground = vec3(0.15, 0.12, 0.095);
const vec3 sun = vec3(2.0, 1.78, 1.48);
void main() {
    float length_of_normal = length(shown_normal);
    vec3 n = length_of_normal > 0.0 ? shown_normal / length_of_normal : to_camera;
    if (!gl_FrontFacing) n = -n;
    vec3 light = mix(ground, sky, 0.5 + 0.5 * n.z) + sun * max(dot(n, to_sun), 0.0);
    // Darkens edges, so that branches contrast with those behind them.
    float facing = clamp(dot(n, to_camera), 0.0, 1.0);
    vec3 linear = min(mix(wood, fresh_wood, shown_mark) * light * (0.55 + 0.45 * sqrt(facing)), vec3(1.0));
    vec3 low = 12.92 * linear, high = 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055;
    color = vec4(mix(high, low, lessThanEqual(linear, vec3(0.0031308))), 1.0);
}
)";

constexpr std::array<float, 3> kBackground{0.925f, 0.94f, 0.955f};  // sRGB
constexpr double kSunAzimuth = -0.9, kSunElevation = 0.85;          // [rad] from the camera, as in render()

// [m] Range of depths in front of the camera.
struct DepthRange {
    double near = std::numeric_limits<double>::infinity(), far = 0;

    void add(const SketchView& camera, std::span<const Vec3> points) {
        for (const Vec3 p : points) {
            const double d = depth(camera, Vec3d(p));
            near = std::min(near, d);
            far = std::max(far, d);
        }
    }
    // With a margin, and never behind the camera.
    DepthRange widened() const {
        const double slack = 0.02 * std::max(far - near, 1e-3 * far);
        return {std::max(near - slack, 1e-4 * far), far + slack};
    }
};

// Columns of the matrix from metres to OpenGL's clip space.
std::array<float, 16> clip_matrix(const SketchView& v, const ViewOptions& options, const DepthRange& range) {
    const double w = options.camera.width, h = options.camera.height, span = range.far - range.near;
    const std::array<std::array<double, 4>, 4> by_camera{
        {{2 * v.k[0][0] / w, 2 * v.k[0][1] / w, 2 * v.k[0][2] / w - 1, 0},
         {0, -2 * v.k[1][1] / h, 1 - 2 * v.k[1][2] / h, 0},
         {0, 0, (range.far + range.near) / span, -2 * range.far * range.near / span},
         {0, 0, 1, 0}}};
    const std::array<std::array<double, 4>, 4> to_camera{{{v.r[0][0], v.r[0][1], v.r[0][2], v.t.x},
                                                          {v.r[1][0], v.r[1][1], v.r[1][2], v.t.y},
                                                          {v.r[2][0], v.r[2][1], v.r[2][2], v.t.z},
                                                          {0, 0, 0, 1}}};
    std::array<float, 16> out{};
    for (std::size_t row = 0; row < 4; ++row) {
        for (std::size_t column = 0; column < 4; ++column) {
            double sum = 0;
            for (std::size_t i = 0; i < 4; ++i) sum += by_camera[row][i] * to_camera[i][column];
            out[4 * column + row] = static_cast<float>(sum);
        }
    }
    return out;
}

Vec3d compute_sun_direction(Vec3d to_camera) {
    const double azimuth = std::atan2(to_camera.y, to_camera.x) + kSunAzimuth;
    return {std::cos(kSunElevation) * std::cos(azimuth), std::cos(kSunElevation) * std::sin(azimuth),
            std::sin(kSunElevation)};
}

}  // namespace

void write_vertices(const VertexBuffers& buffers, std::span<const Vec3> positions,
                    std::span<const Vec3> normals) {
    const auto write = [](std::uint32_t buffer, std::span<const Vec3> values) {
        glBindBuffer(GL_ARRAY_BUFFER, buffer);
        glBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(values.size_bytes()), values.data());
    };
    COPPICE_ASSERT(positions.size() <= buffers.vertex_count && normals.size() <= buffers.vertex_count);
    write(buffers.positions, positions);
    write(buffers.normals, normals);
}

// Members are destroyed in reverse order: the context last.
struct SurfaceView::State {
    OffscreenContext context;
    Canvas canvas;
    GlProgram program{kVertexShader, kFragmentShader};
    view_internal::GlVertexArray vertex_array;
    GlBuffer positions, normals, marked, indices;
    VertexBuffers buffers;
    GLsizei index_count;

    State(const DrawnSurface& surface, const ViewOptions& options)
        : canvas(options.camera.width, options.camera.height, options.smoothing),
          positions(GL_ARRAY_BUFFER, std::as_bytes(surface.positions), GlAttribute{0, 3}),
          normals(GL_ARRAY_BUFFER, std::as_bytes(surface.normals), GlAttribute{1, 3}),
          marked(GL_ARRAY_BUFFER, std::as_bytes(surface.marked),
                 surface.marked.empty() ? std::nullopt : std::optional(GlAttribute{2, 1})),
          indices(GL_ELEMENT_ARRAY_BUFFER, std::as_bytes(surface.triangles)),
          buffers{positions.name(), normals.name(), static_cast<std::uint32_t>(surface.positions.size())},
          index_count(static_cast<GLsizei>(3 * surface.triangles.size())) {}
};

SurfaceView::SurfaceView(const DrawnSurface& surface, const SketchView& camera, const ViewOptions& options,
                         std::span<const Vec3> reached) {
    COPPICE_ASSERT(surface.normals.size() == surface.positions.size());
    COPPICE_ASSERT(surface.marked.empty() || surface.marked.size() == surface.positions.size());
    if (surface.triangles.size() > std::numeric_limits<GLsizei>::max() / 3)
        throw Unsupported(
            "the surface has more than 715 million triangles, which is too many to draw at once");
    state_ = std::make_unique<State>(surface, options);
    DepthRange range;
    range.add(camera, surface.positions);
    range.add(camera, reached);
    const Vec3d to_camera{-camera.r[2][0], -camera.r[2][1], -camera.r[2][2]};
    const GlProgram& program = state_->program;
    program.use();
    program.set("to_clip", clip_matrix(camera, options, range.widened()));
    program.set("to_sun", Vec3(compute_sun_direction(to_camera)));
    program.set("to_camera", Vec3(to_camera));
    glEnable(GL_DEPTH_TEST);
    glClearColor(kBackground[0], kBackground[1], kBackground[2], 1);
    view_internal::check_gl("the surface");
}

SurfaceView::~SurfaceView() = default;

const OffscreenContext& SurfaceView::context() const { return state_->context; }
const VertexBuffers& SurfaceView::buffers() const { return state_->buffers; }

void SurfaceView::draw() {
    state_->canvas.begin();
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glDrawElements(GL_TRIANGLES, state_->index_count, GL_UNSIGNED_INT, nullptr);
    state_->canvas.end();
    glFinish();
}

Image SurfaceView::picture() const { return state_->canvas.picture(); }

}  // namespace coppice
