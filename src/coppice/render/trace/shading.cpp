#include "coppice/render/trace/shading_internal.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "coppice/base/random.h"

namespace coppice {
namespace {

// Lengths are relative to the diagonal of the object's box; light is in units in which a sunlit surface of
// albedo 0.5 is almost saturated.
constexpr float kOffset = 2e-6f;       // offset of secondary rays, above the rounding of positions
constexpr float kSunRadius = 0.03f;    // tangent; larger than that of the real sun, for soft shadows
constexpr float kAmbientReach = 0.6f;  // more distant objects do not occlude the sky
// the shadow on the ground is full up to here, and fades out at kGroundEnd
constexpr float kGroundFull = 0.5f;
constexpr float kGroundEnd = 1.1f;
constexpr Vec3 kSunLight{1.30f, 1.22f, 1.08f};
constexpr Vec3 kSkyLight{0.62f, 0.68f, 0.76f};
constexpr Vec3 kEarthLight{0.34f, 0.31f, 0.28f};
constexpr Vec3 kBounce{0.10f, 0.09f, 0.08f};  // light that closed corners receive from their walls
// Leaves absorb more blue from the light that passes through than from the light that they reflect.
constexpr Vec3 kThrough{1.1f, 1.05f, 0.5f};
constexpr Vec3 kClay{0.42f, 0.345f, 0.27f};
constexpr Vec3 kBackground{0.90f, 0.91f, 0.92f};
constexpr Vec3 kWire{0.03f, 0.03f, 0.04f};
constexpr Vec3 kAxis{0.90f, 0.22f, 0.03f};
constexpr float kAxisCover = 0.85f;
constexpr float kWireCover = 0.8f;
constexpr Vec3 kSignal{0.85f, 0.02f, 0.45f};
constexpr Vec3 kPale{0.50f, 0.50f, 0.48f};  // of a mesh with marked faces
constexpr float kMarkCover = 0.95f;
constexpr float kHiddenMarkCover = 0.7f;
constexpr float kMinFacing =
    0.05f;                      // of the footprint of a sample, which is longer on a face seen from the side
constexpr float kSame = 1e-5f;  // relative distance within which a marked face is the visible one

struct Pair {
    float x, y;
};

float smooth_step(float low, float high, float x) {
    const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
}

/// Returns point `index` of the R2 sequence [Roberts2018], shifted by bits of the pixel, so that adjacent
/// pixels differ.
Pair spread(std::uint32_t index, std::uint64_t bits) {
    const double x = static_cast<double>(bits >> 40) * 0x1p-24 + 0.7548776662466927 * index;
    const double y = static_cast<double>(bits >> 16 & 0xffffff) * 0x1p-24 + 0.5698402909980532 * index;
    return {static_cast<float>(x - std::floor(x)), static_cast<float>(y - std::floor(y))};
}

Vec3 around(Vec3 axis, float radius, float angle, float height) {
    const Vec3 a = perpendicular(axis), b = cross(axis, a);
    return normalized(axis * height + (a * std::cos(angle) + b * std::sin(angle)) * radius, axis);
}

Vec3 cosine_direction(Vec3 normal, Pair p) {
    return around(normal, std::sqrt(p.x), 2 * std::numbers::pi_v<float> * p.y, std::sqrt(1 - p.x));
}

Vec3 sky(Vec3 direction) { return lerp(kEarthLight, kSkyLight, smooth_step(-0.3f, 0.5f, direction.z)); }

float distance_to_segment(Pair p, Pair a, Pair b) {
    const float dx = b.x - a.x, dy = b.y - a.y, px = p.x - a.x, py = p.y - a.y;
    const float square = dx * dx + dy * dy;
    const float t = square > 0 ? std::clamp((px * dx + py * dy) / square, 0.0f, 1.0f) : 0.0f;
    return std::hypot(px - t * dx, py - t * dy);
}

Light over(Light front, Light back) {
    return {front.color + back.color * (1 - front.alpha), front.alpha + back.alpha * (1 - front.alpha)};
}

}  // namespace

struct Shading::Draws {
    Pair sun, sky;
};

struct Shading::Surface {
    Vec3 albedo, normal;
    std::optional<float> roughness;
    float occlusion = 1;
    float transmission = 0;
};

Shading::Shading(const TracedScene& scene, const Camera& camera, const RenderOptions& options,
                 std::span<const TracedMaterial> materials)
    : scene_(scene),
      camera_(camera),
      options_(options),
      materials_(materials),
      ground_height_(scene.bounds().low.z) {
    const float a = options.camera.azimuth + options.sun_azimuth, e = options.sun_elevation;
    sun_ = {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
    ground_visible_ = options.ground && camera.position().z > ground_height_;
}

Light Shading::pixel(int x, int y) const {
    const auto index = static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(options_.camera.width) +
                       static_cast<std::uint64_t>(x);
    const std::uint64_t place = CounterRandom(0, 0).bits(index), sun = CounterRandom(0, 1).bits(index),
                        sky_bits = CounterRandom(0, 2).bits(index);
    // Each kind of random number uses another order of the points; otherwise a corner of the pixel would
    // always sample the same part of the sky.
    const auto count = static_cast<std::uint32_t>(options_.samples);
    const std::uint32_t mask = std::bit_ceil(count) - 1;
    Light sum;
    for (std::uint32_t s = 0; s < count; ++s) {
        const Pair p = spread(s, place);
        const Draws draws{spread(s ^ (static_cast<std::uint32_t>(sun) & mask), sun),
                          spread(s ^ (static_cast<std::uint32_t>(sky_bits) & mask), sky_bits)};
        const Light light = sample(static_cast<float>(x) + p.x, static_cast<float>(y) + p.y, draws);
        sum.color += light.color;
        sum.alpha += light.alpha;
    }
    const float weight = 1 / static_cast<float>(count);
    return {sum.color * weight, sum.alpha * weight};
}

Light Shading::sample(float x, float y, const Draws& draws) const {
    const Camera::Ray ray = camera_.ray(x, y);
    const auto [origin, direction] = ray;
    Light light;
    const auto hit = scene_.trace(origin, direction);
    if (hit) {
        light = solid(*hit, ray, x, y, draws);
    } else {
        const Light back = options_.transparent ? Light{} : Light{kBackground, 1};
        light = ground_visible_ ? over(ground(origin, direction, draws), back) : back;
    }
    if (scene_.has_axis()) {
        if (const auto axis = scene_.trace_axis(origin, direction)) {
            const float bright = 0.35f + 0.65f * dot(axis->normal, -direction);
            const Vec3 color = evidence_color(*axis).value_or(scene_.object_color(*axis).value_or(kAxis));
            light = over({color * (bright * kAxisCover), kAxisCover}, light);
        }
    }
    if (scene_.has_marked()) light = over(marked(origin, direction, hit), light);
    return light;
}

/// Adds marked faces, with a lower opacity if they are hidden.
Light Shading::marked(Vec3 origin, Vec3 direction, const std::optional<Hit>& front) const {
    const auto hit = scene_.trace_marked(origin, direction);
    if (!hit) return {};
    const bool is_hidden = front && front->distance < hit->distance * (1 - kSame);
    const float cover = is_hidden ? kHiddenMarkCover : kMarkCover;
    const float bright = 0.5f + 0.5f * dot(hit->normal, -direction);
    return {kMarkColor * (bright * cover), cover};
}

Vec3 Shading::sun_direction(const Draws& draws) const {
    return around(sun_, kSunRadius * std::sqrt(draws.sun.x), 2 * std::numbers::pi_v<float> * draws.sun.y, 1);
}

std::optional<Vec3> Shading::evidence_color(const Hit& hit) const {
    if (options_.color != RenderColor::evidence || !hit.node) return std::nullopt;
    return deviation_color(1 - 2 * scene_.evidence(*hit.node));
}

Vec3 Shading::albedo(const Hit& hit) const {
    if (const auto color = evidence_color(hit)) return *color;
    if (options_.color == RenderColor::deviation && hit.on_mesh) {
        return deviation_color(scene_.deviation(hit) / options_.deviation_range);
    }
    if (hit.point) return scene_.point_color(*hit.point).value_or(kClay);
    if (options_.color == RenderColor::distance && hit.on_mesh && scene_.measures_mesh()) {
        return deviation_color(static_cast<float>(scene_.distance_to_other(hit) / options_.distance_range));
    }
    if (options_.color == RenderColor::signal) return kSignal;
    if (const auto color = scene_.object_color(hit)) return *color;
    return scene_.has_marked() || scene_.has_point_colors() ? kPale : kClay;
}

/// Returns the part of the face that a sample represents: a pixel divided by the root of their number.
Footprint Shading::footprint(const Hit& hit, const Camera::Ray& ray, float x, float y) const {
    const float facing = dot(ray.direction, hit.geometric_normal);
    const float along = facing < 0 ? std::min(facing, -kMinFacing) : std::max(facing, kMinFacing);
    const auto side = [&](const Camera::Ray& next) {
        const Vec3 off = next.origin - ray.origin + (next.direction - ray.direction) * hit.distance;
        return (off - ray.direction * (dot(off, hit.geometric_normal) / along)) /
               std::sqrt(static_cast<float>(options_.samples));
    };
    return {side(camera_.ray(x + 1, y)), side(camera_.ray(x, y + 1))};
}

Shading::Surface Shading::surface(const Hit& hit, const Camera::Ray& ray, float x, float y) const {
    Surface out{albedo(hit), hit.normal, std::nullopt, 1, 0};
    const auto places = scene_.texture_places(hit);
    if (!places || places->material >= materials_.size()) return out;
    const Texel texel = materials_[places->material].at(*places, footprint(hit, ray, x, y), hit.normal);
    out = {texel.color.value_or(out.albedo), texel.normal, texel.roughness, texel.occlusion,
           texel.transmission};
    if (hit.copy) out.albedo = multiply(out.albedo, scene_.copy_color(*hit.copy));
    return out;
}

/// Adds the light on the visible side and the light that arrives through the surface. One ray towards the sky
/// samples either side, with a probability in proportion to its part of the light.
Light Shading::solid(const Hit& hit, const Camera::Ray& ray, float x, float y, const Draws& draws) const {
    const Surface s = surface(hit, ray, x, y);
    const Vec3 offset = hit.geometric_normal * (kOffset * (4 + hit.distance));
    const Vec3 above = hit.lifted + offset, below = hit.position - offset;
    const Gloss gloss{s.normal, -ray.direction, s.roughness.value_or(1)};
    Vec3 light = kBounce * s.occlusion, through, shine;
    const Vec3 to_sun = sun_direction(draws);
    const float facing = dot(s.normal, to_sun);
    if (facing > 0 && !scene_.occluded(above, to_sun, std::numeric_limits<float>::infinity())) {
        light += kSunLight * facing;
        if (s.roughness) shine += kSunLight * gloss.of_source(to_sun);
    }
    if (facing < 0 && s.transmission > 0 &&
        !scene_.occluded(below, to_sun, std::numeric_limits<float>::infinity()))
        through += kSunLight * (-facing * s.transmission);
    const float share = s.transmission / (1 + s.transmission);
    const bool is_below = draws.sky.x < share;
    const Pair place{is_below ? draws.sky.x / share : (draws.sky.x - share) / (1 - share), draws.sky.y};
    const Vec3 to_sky = cosine_direction(is_below ? -s.normal : s.normal, place);
    if (!scene_.occluded(is_below ? below : above, to_sky, kAmbientReach)) {
        (is_below ? through : light) += sky(to_sky) * (s.occlusion * (1 + s.transmission));
        if (s.roughness) shine += sky(gloss.sky_direction()) * (gloss.of_sky() * s.occlusion);
    }
    Vec3 color = multiply(s.albedo, light + multiply(kThrough, through)) + shine;
    if (options_.wireframe && hit.on_mesh) color = lerp(color, kWire, kWireCover * wire(hit, x, y));
    return {color, 1};
}

/// Returns the coverage of the point (x, y) of the image by an edge of the face. Edges of faces smaller than
/// a few pixels fade, because they would only blacken the surface.
float Shading::wire(const Hit& hit, float x, float y) const {
    const TracedMesh& mesh = scene_.mesh();
    const Quad& q = mesh.quads()[hit.place.face];
    std::array<Pair, 4> corner;
    for (std::size_t k = 0; k < 4; ++k) {
        const auto p = camera_.project(mesh.positions()[q[k]]);
        if (p.depth <= 0) return 0;
        corner[k] = {p.x, p.y};
    }
    float nearest = std::numeric_limits<float>::infinity(), longest = 0;
    for (int k = 0; k < 4; ++k) {
        const Pair a = corner[static_cast<std::size_t>(k)], b = corner[static_cast<std::size_t>((k + 1) % 4)];
        longest = std::max(longest, std::hypot(b.x - a.x, b.y - a.y));
        if (mesh.has_edge(hit.place.face, k)) nearest = std::min(nearest, distance_to_segment({x, y}, a, b));
    }
    const float half = 0.5f * options_.wire_width;
    return (1 - smooth_step(half - 0.5f, half + 0.5f, nearest)) *
           smooth_step(2, 8, longest / options_.wire_width);
}

/// Returns the shadow on a transparent ground: black with the fraction of missing light as alpha.
Light Shading::ground(Vec3 origin, Vec3 direction, const Draws& draws) const {
    if (direction.z >= -1e-6f) return {};
    const float t = (ground_height_ - origin.z) / direction.z;
    const Vec3 p = origin + direction * t;
    const float strength = 1 - smooth_step(kGroundFull, kGroundEnd, std::hypot(p.x, p.y));
    if (strength <= 0) return {};
    const Vec3 from = p + Vec3{0, 0, kOffset * 4};
    float missing = 0;
    if (scene_.occluded(from, sun_direction(draws), std::numeric_limits<float>::infinity())) missing += 0.42f;
    if (scene_.occluded(from, cosine_direction({0, 0, 1}, draws.sky), kAmbientReach)) missing += 0.38f;
    return {Vec3{}, missing * strength};
}

}  // namespace coppice
