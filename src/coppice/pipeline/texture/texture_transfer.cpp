#include "coppice/pipeline/texture/texture_transfer_internal.h"

#include <algorithm>
#include <array>
#include <limits>

#include "coppice/measure/surface_tree.h"

namespace coppice::pipeline_internal {
namespace {

struct Vec2 {
    float x, y;
};
Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
Vec2 operator*(Vec2 a, float s) { return {a.x * s, a.y * s}; }
float cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }

// Maximum distance of coordinates from those of the quad, in its widths.
constexpr float kMaxBeyond = 0.5f;
constexpr int kNewtonSteps = 5;

// Returns the coordinates in [0, 1] of a point in a bilinear quad, both continued a little beyond it.
Vec2 invert_bilinear(const std::array<Vec2, 4>& q, Vec2 p) {
    Vec2 s{0.5f, 0.5f};
    const Vec2 u = q[1] - q[0], v = q[3] - q[0], uv = q[0] - q[1] + q[2] - q[3];
    for (int step = 0; step < kNewtonSteps; ++step) {
        const Vec2 error = q[0] + u * s.x + v * s.y + uv * (s.x * s.y) - p;
        const Vec2 du = u + uv * s.y, dv = v + uv * s.x;
        const float det = cross(du, dv);
        if (!(std::abs(det) > 0)) break;
        s = s - Vec2{cross(error, dv) / det, cross(du, error) / det};
        s.x = std::clamp(s.x, -kMaxBeyond, 1 + kMaxBeyond);
        s.y = std::clamp(s.y, -kMaxBeyond, 1 + kMaxBeyond);
    }
    return s;
}

// Returns these coordinates for the projection of a point on the plane of a quad.
Vec2 locate(const std::array<Vec3, 4>& q, Vec3 p) {
    const Vec3 normal = normalized(cross(q[2] - q[0], q[3] - q[1]), Vec3{0, 0, 1});
    const Vec3 side = q[1] - q[0] + (q[2] - q[3]);
    const Vec3 x = normalized(side - normal * dot(side, normal), perpendicular(normal)), y = cross(normal, x);
    const auto flat = [&](Vec3 at) { return Vec2{dot(at - q[0], x), dot(at - q[0], y)}; };
    return invert_bilinear({flat(q[0]), flat(q[1]), flat(q[2]), flat(q[3])}, flat(p));
}

}  // namespace

TextureTransfer::TextureTransfer(const QuadBuild& build, const TubeTexture& texture,
                                 std::span<const std::uint8_t> tubes, const Context& ctx)
    : build_(build), texture_(texture), quads_(find_quads(tubes)), tree_(boxes(), ctx) {}

std::vector<TextureTransfer::CarrierQuad> TextureTransfer::find_quads(
    std::span<const std::uint8_t> tubes) const {
    std::vector<CarrierQuad> out;
    const auto add = [&](std::uint32_t cage_quad) {
        if (!texture_.patch(cage_quad).is_rectangle()) return;
        for (std::uint32_t row = 0; row < texture_.size(); ++row) {
            for (std::uint32_t column = 0; column < texture_.size(); ++column)
                out.push_back({cage_quad, column, row});
        }
    };
    for (std::size_t tube = 0; tube < tubes.size(); ++tube) {
        if (tubes[tube] == 0) continue;
        const TubeFaces& faces = texture_.faces()[tube];
        for (const CageRun& run : {faces.side, faces.fork[0], faces.fork[1]}) {
            for (std::uint32_t f = run.first; f < run.first + run.count; ++f) add(f);
        }
    }
    return out;
}

std::array<Vec3, 4> TextureTransfer::corners(const CarrierQuad& q) const {
    const auto at = [&](std::uint32_t column, std::uint32_t row) {
        return build_.refined[texture_.vertex(q.cage_quad, column, row)];
    };
    return {at(q.column, q.row), at(q.column + 1, q.row), at(q.column + 1, q.row + 1),
            at(q.column, q.row + 1)};
}

std::vector<Box3> TextureTransfer::boxes() const {
    std::vector<Box3> out(quads_.size());
    for (std::size_t i = 0; i < quads_.size(); ++i) {
        for (const Vec3 p : corners(quads_[i])) out[i].extend(p);
    }
    return out;
}

double TextureTransfer::squared_distance(std::uint32_t quad, Vec3d p) const {
    const auto q = corners(quads_[quad]);
    return std::min(distance_squared(p, Vec3d(q[0]), Vec3d(q[1]), Vec3d(q[2])),
                    distance_squared(p, Vec3d(q[0]), Vec3d(q[2]), Vec3d(q[3])));
}

std::uint32_t TextureTransfer::find_nearest(Vec3d p, std::uint32_t near, std::uint32_t axis) const {
    std::uint32_t nearest = near;
    double least = near == kNoIndex ? std::numeric_limits<double>::infinity() : squared_distance(near, p);
    const auto bound = [&](std::uint32_t level, std::uint32_t i) {
        return distance_squared(tree_.level(level)[i], p);
    };
    tree_.search(bound, least, [&](std::uint32_t item) {
        if (axis != kNoIndex && texture_.patch(quads_[item].cage_quad).axis != axis) return;
        const double d = squared_distance(item, p);
        if (d > least || (d == least && item > nearest)) return;
        least = d;
        nearest = item;
    });
    return nearest;
}

BarkPoint TextureTransfer::evaluate(std::uint32_t nearest, Vec3 point) const {
    if (nearest == kNoIndex) return {};
    const CarrierQuad& q = quads_[nearest];
    const TexturePatch& patch = texture_.patch(q.cage_quad);
    const std::array<Vec3, 4> corner = corners(q);
    const Vec2 s = locate(corner, point);
    const Vec3 along = normalized(corner[3] - corner[0] + (corner[2] - corner[1]));
    const float left = texture_.turns(patch, q.column), right = texture_.turns(patch, q.column + 1);
    const auto interpolate_v = [&](std::uint32_t row) {
        const float first = texture_.v(patch, q.column, row);
        return first + (texture_.v(patch, q.column + 1, row) - first) * s.x;
    };
    const float low = interpolate_v(q.row), high = interpolate_v(q.row + 1);
    return {patch.axis,
            patch.wraps,
            left + (right - left) * s.x,
            low + (high - low) * s.y,
            patch.tiles_per_metre,
            high < low ? -along : along,
            patch.zone,
            patch.tube,
            texture_.share(patch, static_cast<float>(q.row) + std::clamp(s.y, 0.0f, 1.0f))};
}

}  // namespace coppice::pipeline_internal
