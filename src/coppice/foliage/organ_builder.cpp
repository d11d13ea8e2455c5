#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/base/frame.h"
#include "coppice/foliage/organ_builder_internal.h"

namespace coppice::foliage_internal {
namespace {

constexpr float kTurn = 2 * std::numbers::pi_v<float>;

}  // namespace

Vec3 OrganFrame::around(float azimuth) const { return across * std::cos(azimuth) + up * std::sin(azimuth); }

Vec3 OrganFrame::point(float radius, float azimuth, float height) const {
    return origin + around(azimuth) * radius + along * height;
}

OrganFrame make_organ_frame(Vec3 origin, Vec3 along) {
    const Vec3 across = perpendicular(along);
    return {origin, across, along, cross(across, along)};
}

std::uint32_t OrganBuilder::add(Vec3 p) {
    mesh_.positions.push_back(p);
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
}

void OrganBuilder::add_face(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh_.triangles.push_back(Triangle{a, b, c});
}

void OrganBuilder::add_triangle(Vec3 a, Vec3 b, Vec3 c) {
    const std::uint32_t first = add(a);
    add(b);
    add(c);
    add_face(first, first + 1, first + 2);
}

void OrganBuilder::add_revolution(const OrganFrame& frame, const std::vector<Point2>& profile, int sides) {
    const auto n = static_cast<std::uint32_t>(sides), rings = static_cast<std::uint32_t>(profile.size()) - 2;
    const std::uint32_t base = add(frame.point(0, 0, profile.front().y)), first = base + 1;
    for (std::uint32_t i = 1; i <= rings; ++i) {
        for (std::uint32_t k = 0; k < n; ++k)
            add(frame.point(profile[i].x, kTurn * static_cast<float>(k) / static_cast<float>(n),
                            profile[i].y));
    }
    const std::uint32_t tip = add(frame.point(0, 0, profile.back().y)), last = first + (rings - 1) * n;
    for (std::uint32_t k = 0; k < n; ++k) {
        const std::uint32_t next = (k + 1) % n;
        add_face(base, first + k, first + next);
        for (std::uint32_t i = 0; i + 1 < rings; ++i) {
            const std::uint32_t a = first + i * n + k, b = first + i * n + next;
            add_face(a, a + n, b);
            add_face(b, a + n, b + n);
        }
        add_face(last + k, tip, last + next);
    }
}

void OrganBuilder::add_tube(Vec3 from, Vec3 to, float width) {
    const float length = distance(from, to);
    if (length <= 0) return;
    const float radius = 0.5f * width;
    add_revolution(make_organ_frame(from, (to - from) / length),
                   {{0, 0}, {radius, 0}, {0.75f * radius, length}, {0, length}}, 3);
}

void OrganBuilder::add_spine(const OrganFrame& frame, float width, float length) {
    const std::uint32_t tip = add(frame.point(0, 0, length)), first = tip + 1;
    for (std::uint32_t k = 0; k < 3; ++k)
        add(frame.point(0.5f * width, kTurn * static_cast<float>(k) / 3, 0));
    for (std::uint32_t k = 0; k < 3; ++k) add_face(first + k, tip, first + (k + 1) % 3);
}

void OrganBuilder::add_rows(const std::vector<std::vector<Vec3>>& rows) {
    std::vector<std::vector<std::uint32_t>> ids;
    for (const std::vector<Vec3>& row : rows) {
        ids.emplace_back();
        for (const Vec3 p : row) ids.back().push_back(add(p));
    }
    for (std::size_t i = 0; i + 1 < ids.size(); ++i) {
        const auto &low = ids[i], &high = ids[i + 1];
        const std::size_t columns = std::max(low.size(), high.size()) - 1;
        for (std::size_t k = 0; k < columns; ++k) {
            if (low.size() > 1) add_face(low[k], low[k + 1], high.size() > 1 ? high[k] : high[0]);
            if (high.size() > 1) add_face(low.size() > 1 ? low[k + 1] : low[0], high[k + 1], high[k]);
        }
    }
}

Prototype OrganBuilder::take(std::uint32_t material) {
    Prototype out{.name = "organ", .mesh = std::move(mesh_), .texture = {}, .material = material};
    for (std::size_t i = 0; i < out.mesh.triangles.size(); ++i) {
        for (const TexturePoint p : {TexturePoint{0, 0}, TexturePoint{1, 0}, TexturePoint{0.5f, 1}})
            out.texture.push_back(p);
    }
    mesh_ = {};
    return out;
}

}  // namespace coppice::foliage_internal
