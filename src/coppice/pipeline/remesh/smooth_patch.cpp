#include "coppice/pipeline/remesh/smooth_patch_internal.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/id.h"
#include "coppice/base/parallel.h"

namespace coppice {
namespace {

constexpr float kWeight = 0.6f;        // share of the distance to the neighbours' mean
constexpr float kLongestStep = 0.25f;  // [radii]
constexpr int kSteps = 2;              // along the gradient, per pass
constexpr std::size_t kBatch = 64;     // vertices per evaluation of the field

// Returns one step of Newton's method on value^(2/5) along the gradient, which is nearly linear for compact
// kernels.
Vec3 towards_level(FieldSample here, float level, float longest) {
    const float slope = length(here.gradient);
    if (!(slope > 0) || !(here.value > 0)) return {};
    const float relative = here.value / level;
    const float way = (std::pow(relative, -0.4f) - 1) * here.value / (0.4f * slope);
    return here.gradient * (std::clamp(way, -longest, longest) / slope);
}

// Per moving vertex: its neighbours along the edges of the quads.
CompressedRows<std::uint32_t> neighbours(std::span<const Quad> quads, std::span<const PatchVertex> moving) {
    std::uint32_t last = 0;
    for (const PatchVertex& m : moving) last = std::max(last, m.vertex);
    std::vector<std::uint32_t> row(last + 1, kNoIndex);
    for (std::uint32_t i = 0; i < moving.size(); ++i) row[moving[i].vertex] = i;
    return compress_rows<std::uint32_t>(moving.size(), [&](const auto& put) {
        for (const Quad& q : quads) {
            for (std::size_t k = 0; k < 4; ++k) {
                if (q[k] <= last && row[q[k]] != kNoIndex) put(row[q[k]], q[(k + 1) % 4]);
            }
        }
    });
}

}  // namespace

void move_to_level(std::span<Vec3> points, std::span<const PatchVertex> vertices, FieldRef field) {
    COPPICE_ASSERT(points.size() <= kBatch);
    std::array<FieldSample, kBatch> samples;
    for (int step = 0; step < kSteps; ++step) {
        const auto here = std::span(samples).first(points.size());
        field.sample(vertices[0].region, points, here);
        for (std::size_t i = 0; i < points.size(); ++i)
            points[i] += towards_level(here[i], field.level(), kLongestStep * vertices[i].radius);
    }
}

void smooth_patch(std::span<Vec3> positions, std::span<const Quad> quads, std::span<const PatchVertex> moving,
                  FieldRef field, int passes, const Context& ctx) {
    const CompressedRows<std::uint32_t> ring = neighbours(quads, moving);
    std::vector<Vec3> moved(moving.size());
    for (int pass = 0; pass < passes; ++pass) {
        ctx.throw_if_cancelled();
        parallel_for_ranges(ctx, moving.size(), kBatch, [&](IndexRange range) {
            for (std::size_t i = range.begin; i < range.end; ++i) {
                const Vec3 p = positions[moving[i].vertex];
                Vec3 sum;
                for (const std::uint32_t v : ring[i]) sum += positions[v] - p;
                moved[i] = ring[i].empty() ? p : p + sum * (kWeight / static_cast<float>(ring[i].size()));
            }
            for (std::size_t i = range.begin; i < range.end;) {
                std::size_t end = i + 1;
                while (end < range.end && moving[end].region == moving[i].region) ++end;
                move_to_level(std::span(moved).subspan(i, end - i), moving.subspan(i, end - i), field);
                i = end;
            }
        });
        for (std::size_t i = 0; i < moving.size(); ++i) {
            if (is_finite(moved[i])) positions[moving[i].vertex] = moved[i];
        }
    }
}

void enclose_volume(std::span<Vec3> positions, std::span<const Quad> quads,
                    std::span<const PatchVertex> moving) {
    const CompressedRows<std::uint32_t> ring = neighbours(quads, moving);
    std::vector<Vec3d> normals(positions.size());
    for (const Quad& q : quads) {
        const Vec3d normal =
            cross(Vec3d(positions[q[2]] - positions[q[0]]), Vec3d(positions[q[3]] - positions[q[1]]));
        for (const std::uint32_t v : q) normals[v] += normal;
    }
    std::vector<Vec3> moved(moving.size());
    for (std::size_t i = 0; i < moving.size(); ++i) {
        const std::uint32_t vertex = moving[i].vertex;
        Vec3 sum;
        for (const std::uint32_t v : ring[i]) sum += positions[vertex] - positions[v];
        const Vec3d normal = normalized(normals[vertex]);
        const double distance =
            ring[i].empty() ? 0 : dot(Vec3d(sum), normal) / (3.0 * static_cast<double>(ring[i].size()));
        moved[i] = positions[vertex] + Vec3(normal * distance);
    }
    for (std::size_t i = 0; i < moving.size(); ++i) {
        if (is_finite(moved[i])) positions[moving[i].vertex] = moved[i];
    }
}

}  // namespace coppice
