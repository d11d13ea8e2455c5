#include "coppice/pipeline/texture/atlas_charts_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/id.h"
#include "coppice/pipeline/texture/tube_unroll_internal.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::size_t kVertexGrain = 4096;
constexpr std::size_t kChartGrain = 16;
// Charts with fewer faces are joined with others.
constexpr std::size_t kMinFaces = 4;
// Minimum cosine of the angle between the normals of the faces of a projected chart and the first one.
constexpr float kMinCosine = 0.7f;

// Corners at each vertex.
struct VertexCorners {
    CompressedRows<std::uint32_t> at;  // per vertex, the corners
    std::vector<std::uint32_t> face;   // per corner

    explicit VertexCorners(const AtlasFaces& faces) : face(faces.corner_count()) {
        std::vector<std::uint32_t> vertex(faces.corner_count());
        for (std::uint32_t f = 0; f < faces.size(); ++f) {
            std::ranges::copy(faces.vertices(f), faces.values(std::span(vertex), f).begin());
            std::ranges::fill(faces.values(std::span(face), f), f);
        }
        at = group_by(vertex, faces.vertex_count());
    }
};

// Equal up to rounding.
bool are_equal(TexturePoint a, TexturePoint b) {
    const float scale = std::max({1.0f, std::abs(a.u), std::abs(a.v)});
    const float tolerance = 4 * std::numeric_limits<float>::epsilon() * scale;
    return std::abs(a.u - b.u) <= tolerance && std::abs(a.v - b.v) <= tolerance;
}

// Returns per corner the first one at its vertex with the same coordinates.
std::vector<std::uint32_t> weld_corners(const VertexCorners& at, std::span<const TexturePoint> bark,
                                        const Context& ctx) {
    std::vector<std::uint32_t> out(bark.size());
    parallel_for(ctx, at.at.size(), kVertexGrain, [&](std::size_t v) {
        const auto corners = at.at[v];
        for (std::size_t i = 0; i < corners.size(); ++i) {
            out[corners[i]] = corners[i];
            for (std::size_t j = 0; j < i; ++j) {
                if (out[corners[j]] != corners[j] || !are_equal(bark[corners[j]], bark[corners[i]])) continue;
                out[corners[i]] = corners[j];
                break;
            }
        }
    });
    return out;
}

// Returns the sets of faces that share welded corners, in the order of their first faces.
std::vector<Chart> find_pieces(const AtlasFaces& faces, const VertexCorners& at,
                               std::span<const std::uint32_t> welded) {
    DisjointSets sets(faces.size());
    for (std::uint32_t c = 0; c < welded.size(); ++c) {
        if (welded[c] != c) sets.join(at.face[c], at.face[welded[c]]);
    }
    std::vector<Chart> out;
    std::vector<std::uint32_t> piece(faces.size(), kNoIndex);
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
        std::uint32_t& own = piece[sets.find(f)];
        if (own == kNoIndex) {
            own = static_cast<std::uint32_t>(out.size());
            out.emplace_back();
        }
        out[own].push_back(f);
    }
    return out;
}

// Projects faces on a plane through a point.
void project_chart(const AtlasFaces& faces, const Chart& chart, Vec3 point, Vec3 normal,
                   std::span<PlanePoint> points) {
    const Vec3 y = perpendicular(normal), x = cross(y, normal);
    for (const std::uint32_t f : chart) {
        const auto out = faces.values(points, f);
        for (std::size_t k = 0; k < out.size(); ++k) {
            const Vec3 d = faces.position(f, k) - point;
            out[k] = {dot(d, x), dot(d, y)};
        }
    }
}

// Makes charts of the faces that are marked, and of their marked neighbours with similar normals.
class ProjectedCharts {
  public:
    ProjectedCharts(const AtlasFaces& faces, const VertexCorners& at, std::vector<std::uint8_t> wanted,
                    AtlasCharts& out)
        : faces_(faces), at_(at), wanted_(std::move(wanted)), out_(out) {}

    void run() {
        for (std::uint32_t f = 0; f < faces_.size(); ++f) {
            if (wanted_[f] != 0) add_chart(f);
        }
    }

  private:
    void add_chart(std::uint32_t seed) {
        const Vec3 normal = normalized(doubled_area_normal(faces_, seed));
        Chart chart{seed};
        wanted_[seed] = 0;
        for (std::size_t i = 0; i < chart.size(); ++i) {
            for (const std::uint32_t v : faces_.vertices(chart[i])) {
                for (const std::uint32_t corner : at_.at[v]) {
                    const std::uint32_t f = at_.face[corner];
                    if (wanted_[f] == 0) continue;
                    const Vec3 other = normalized(doubled_area_normal(faces_, f), -normal);
                    if (!(dot(other, normal) > kMinCosine)) continue;
                    wanted_[f] = 0;
                    chart.push_back(f);
                }
            }
        }
        project_chart(faces_, chart, faces_.position(seed, 0), normal, out_.points);
        out_.projected += chart.size();
        out_.charts.push_back(std::move(chart));
    }

    const AtlasFaces& faces_;
    const VertexCorners& at_;
    std::vector<std::uint8_t> wanted_;  // per face
    AtlasCharts& out_;
};

}  // namespace

Vec3 doubled_area_normal(const AtlasFaces& faces, std::uint32_t face) {
    const std::size_t count = faces.vertices(face).size();
    const Vec3 origin = faces.position(face, 0);
    Vec3 out;
    for (std::size_t k = 1; k + 1 < count; ++k)
        out += cross(faces.position(face, k) - origin, faces.position(face, k + 1) - origin);
    return out;
}

void flatten_face(const AtlasFaces& faces, std::uint32_t face, std::span<PlanePoint> points) {
    project_chart(faces, {face}, faces.position(face, 0), normalized(doubled_area_normal(faces, face)),
                  points);
}

AtlasCharts make_charts(const AtlasFaces& faces, std::span<const TexturePoint> bark, float max_length,
                        const Context& ctx) {
    AtlasCharts out;
    out.points.resize(bark.size());
    const VertexCorners at(faces);
    const std::vector<std::uint32_t> welded = weld_corners(at, bark, ctx);
    const std::vector<Chart> pieces = find_pieces(faces, at, welded);
    std::vector<UnrolledTube> unrolled(pieces.size());
    std::vector<std::uint8_t> is_left(faces.size(), 0);
    const TubeUnroll unroll(faces, bark, welded, max_length);
    parallel_for(ctx, pieces.size(), kChartGrain, [&](std::size_t i) {
        if (pieces[i].size() >= kMinFaces) {
            unrolled[i] = unroll.run(pieces[i], out.points);
        } else {
            unrolled[i].left = pieces[i];
        }
        for (const std::uint32_t f : unrolled[i].left) is_left[f] = 1;
    });
    for (UnrolledTube& tube : unrolled)
        out.charts.insert(out.charts.end(), std::move_iterator(tube.charts.begin()),
                          std::move_iterator(tube.charts.end()));
    ProjectedCharts(faces, at, std::move(is_left), out).run();
    return out;
}

}  // namespace coppice::pipeline_internal
