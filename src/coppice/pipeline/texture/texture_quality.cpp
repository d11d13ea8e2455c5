#include "coppice/pipeline/texture/texture_quality_internal.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "coppice/base/parallel.h"
#include "coppice/pipeline/texture/atlas_faces_internal.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::size_t kFaceGrain = 4096;
constexpr double kMaxDensityRatio = 4;

double area(Vec3 a, Vec3 b, Vec3 c) { return 0.5 * double{length(cross(b - a, c - a))}; }

double area(std::span<const Vec3> face) {
    double out = 0;
    for (std::size_t k = 1; k + 1 < face.size(); ++k) out += area(face[0], face[k], face[k + 1]);
    return out;
}

// Returns whether the texture is turned over at a corner.
bool is_flipped(std::span<const TexturePoint> face) {
    const std::size_t n = face.size();
    for (std::size_t k = 0; k < n; ++k) {
        if (!(signed_area(face[(k + n - 1) % n], face[k], face[(k + 1) % n]) > 0)) return true;
    }
    return false;
}

// Number of faces up to which all densities are measured.
constexpr std::size_t kMaxSamples = std::size_t{1} << 17;

// One face of a texture.
struct FaceDensity {
    float density;  // [tiles per tile of the given width]
    float area;     // [m^2]
};

// Returns the minimum density up to which the faces have the given area, which reorders them; 0 without
// faces. O(n).
double find_density(std::span<FaceDensity> faces, double wanted) {
    while (faces.size() > 1) {
        const std::size_t middle = faces.size() / 2;
        std::ranges::nth_element(faces, faces.begin() + static_cast<std::ptrdiff_t>(middle), {},
                                 &FaceDensity::density);
        double below = 0;
        for (const FaceDensity& f : faces.first(middle)) below += double{f.area};
        const bool is_above = below < wanted;
        if (is_above) wanted -= below;
        faces = is_above ? faces.subspan(middle) : faces.first(middle);
    }
    return faces.empty() ? 0 : double{faces[0].density};
}

// Returns the densities below which the given shares of the area are.
std::array<double, 3> density_quantiles(std::vector<FaceDensity> faces, std::array<double, 3> shares) {
    double total = 0;
    for (const FaceDensity& f : faces) total += double{f.area};
    std::array<double, 3> out{};
    std::ranges::transform(shares, out.begin(),
                           [&](double share) { return find_density(faces, share * total); });
    return out;
}

// Calls corners(i) for the coordinates of a face, and surface_area(i) [m^2]. The densities are those of
// evenly chosen faces.
template <class Corners, class Area>
void measure(std::size_t count, const Corners& corners, const Area& surface_area, const TileWidths& tiles,
             TextureReport& report, const Context& ctx) {
    const std::size_t step = count / kMaxSamples | 1;  // odd, unlike the numbers of quads of a patch
    std::vector<FaceDensity> density((count + step - 1) / step);
    std::vector<std::uint8_t> flipped(count);
    parallel_for(ctx, count, kFaceGrain, [&](std::size_t i) {
        const double mapped = texture_area(corners(i));
        flipped[i] = mapped < 0 ? 1 : 0;
        if (i % step != 0) return;
        const double surface = surface_area(i);
        const double ratio = surface > 0 ? std::sqrt(std::max(mapped, 0.0) / surface) : 0;
        density[i / step] = {static_cast<float>(ratio * double{tiles.at(i)}), static_cast<float>(surface)};
    });
    report.flipped = static_cast<std::uint64_t>(std::ranges::count(flipped, 1));
    const auto q = density_quantiles(std::move(density), {0.05, 0.5, 0.95});
    report.density_p5 = q[0];
    report.density_p50 = q[1];
    report.density_p95 = q[2];
}

template <std::size_t N>
void measure_equal(std::span<const std::array<std::uint32_t, N>> faces, std::span<const Vec3> positions,
                   std::span<const TexturePoint> texture, const TileWidths& tiles, TextureReport& report,
                   const Context& ctx) {
    measure(
        faces.size(), [&](std::size_t i) { return texture.subspan(N * i, N); },
        [&](std::size_t i) { return area(face_positions(faces[i], positions)); }, tiles, report, ctx);
}

}  // namespace

bool is_good_texture(std::span<const Vec3> face, std::span<const TexturePoint> texture,
                     float tiles_per_metre) {
    if (is_flipped(texture)) return false;
    const double surface = area(face);
    if (!(surface > 0)) return true;
    const double ratio = std::sqrt(texture_area(texture) / surface) / double{tiles_per_metre};
    return ratio < kMaxDensityRatio && ratio > 1 / kMaxDensityRatio;
}

void project_on_plane(std::span<const Vec3> face, const TexturePlane& plane, float tiles_per_metre,
                      std::span<TexturePoint> out) {
    const Vec3 n = normalized(plane.normal);
    const Vec3 y = normalized(plane.along - n * dot(plane.along, n), perpendicular(n)), x = cross(y, n);
    for (std::size_t k = 0; k < face.size(); ++k) {
        const Vec3 d = face[k] - plane.point;
        out[k] = {dot(d, x) * tiles_per_metre, dot(d, y) * tiles_per_metre};
    }
}

void measure_texture(std::span<const Quad> faces, std::span<const Vec3> positions,
                     std::span<const TexturePoint> texture, const TileWidths& tiles, TextureReport& report,
                     const Context& ctx) {
    measure_equal(faces, positions, texture, tiles, report, ctx);
}

void measure_texture(std::span<const Triangle> faces, std::span<const Vec3> positions,
                     std::span<const TexturePoint> texture, const TileWidths& tiles, TextureReport& report,
                     const Context& ctx) {
    measure_equal(faces, positions, texture, tiles, report, ctx);
}

void measure_texture(const FaceView& mesh, std::span<const TexturePoint> texture, const TileWidths& tiles,
                     TextureReport& report, const Context& ctx) {
    const AtlasFaces faces(mesh);
    const auto surface_area = [&](std::size_t i) {
        std::vector<Vec3> positions;
        for (const std::uint32_t v : mesh.face(static_cast<std::uint32_t>(i)))
            positions.push_back(mesh.positions()[v]);
        return area(positions);
    };
    measure(
        mesh.size(), [&](std::size_t i) { return faces.values(texture, static_cast<std::uint32_t>(i)); },
        surface_area, tiles, report, ctx);
}

}  // namespace coppice::pipeline_internal
