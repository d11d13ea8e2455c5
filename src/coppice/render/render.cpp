#include "coppice/render/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/base/sort.h"
#include "coppice/render/colors.h"
#include "coppice/render/radius_colors.h"
#include "coppice/render/trace/ring_internal.h"
#include "coppice/render/trace/scale_bar_internal.h"
#include "coppice/render/trace/shading_internal.h"
#include "coppice/render/value_colors.h"

namespace coppice {
namespace {

constexpr long long kMaxPixels = 128'000'000;
constexpr int kTile = 16;           // [pixels] side of a square that is traced as a unit, for the caches
constexpr int kRowsPerReport = 64;  // between two progress reports
constexpr float kBuildShare = 0.3f;

void check(const PointCloud& cloud, float radius) {
    const std::size_t n = cloud.points.size();
    if (n == 0) throw InvalidInput("render: the cloud has no points");
    if (!(radius > 0)) throw InvalidInput("render: the points have no radius");
    if ((!cloud.colors.empty() && cloud.colors.size() != n) ||
        (!cloud.distances.empty() && cloud.distances.size() != n))
        throw InvalidInput("render: the number of colours or distances must be that of the points, or 0");
    for (std::size_t i = 0; i < n; ++i) {
        if (!is_finite(cloud.points.positions[i]))
            throw InvalidInput(fmt::format("render: point {} has no finite position", i));
    }
}

bool has_drawn_copies(const RenderScene& scene, const RenderOptions& options) {
    return scene.instances != nullptr && !scene.instances->empty() &&
           (options.color == RenderColor::plain || options.color == RenderColor::signal);
}

void check(const RenderMaterial& material) {
    if (material.cut_out && material.color.pixels.empty())
        throw InvalidInput("render: a material with holes requires an image of its colour");
    if (!(material.transmission >= 0 && std::isfinite(material.transmission)))
        throw InvalidInput("render: the transmission of a material must be >= 0");
}

void check(const RenderMaterial& material, const PolygonMesh* mesh) {
    if (mesh == nullptr || mesh->texture.empty())
        throw InvalidInput("render: a material requires a mesh with texture coordinates");
    if (mesh->texture.size() != mesh->corners.size())
        throw InvalidInput("render: the number of texture coordinates must be that of the corners");
    for (const TexturePoint t : mesh->texture) {
        if (!std::isfinite(t.u) || !std::isfinite(t.v))
            throw InvalidInput("render: the texture coordinates of the mesh are not finite");
    }
    if (!mesh->texture_blends.empty() && mesh->texture_blends.size() != mesh->corners.size())
        throw InvalidInput("render: the number of second texture coordinates must be that of the corners");
    for (const TextureBlend& b : mesh->texture_blends) {
        if (!std::isfinite(b.second.u) || !std::isfinite(b.second.v) || !(b.weight >= 0 && b.weight <= 1))
            throw InvalidInput(
                "render: the second texture coordinates of the mesh are not finite, or a weight is not from "
                "0 to 1");
    }
    const Image* images[] = {&material.color, &material.normal, &material.roughness, &material.occlusion};
    if (std::ranges::all_of(images, [](const Image* image) { return image->pixels.empty(); }))
        throw InvalidInput("render: the material has no image");
    check(material);
}

void check_copies(const RenderScene& scene) {
    validate(scene.prototypes, *scene.instances);
    for (const Prototype& prototype : scene.prototypes) {
        for (const Vec3 p : prototype.mesh.positions) {
            if (!is_finite(p))
                throw InvalidInput(
                    fmt::format("render: prototype '{}' has no finite position", prototype.name));
        }
        for (const TexturePoint t : prototype.texture) {
            if (!std::isfinite(t.u) || !std::isfinite(t.v))
                throw InvalidInput(fmt::format(
                    "render: the texture coordinates of prototype '{}' are not finite", prototype.name));
        }
    }
    for (const RenderMaterial& material : scene.prototype_materials) check(material);
}

/// Returns whether the colour shows the numbers of the vertices.
bool uses_values(const RenderScene& scene, RenderColor color) {
    return color == RenderColor::order || color == RenderColor::branch || color == RenderColor::along ||
           (color == RenderColor::radius && (scene.skeleton == nullptr || !scene.vertex_values.empty()));
}

ValueScale choose_scale(RenderColor color) {
    if (color == RenderColor::radius) return ValueScale::logarithmic;
    return color == RenderColor::branch ? ValueScale::numbers : ValueScale::linear;
}

void check(const RenderScene& scene, const RenderOptions& options) {
    check_fields(options, "render");
    const auto pixels = static_cast<long long>(options.camera.width) * options.camera.height;
    if (pixels > kMaxPixels) {
        throw InvalidInput(
            fmt::format("render: {} x {} pixels are more than {} million; choose a smaller image",
                        options.camera.width, options.camera.height, kMaxPixels / 1'000'000));
    }
    if (scene.view != nullptr) validate(*scene.view, "render: view");
    const bool copies = has_drawn_copies(scene, options);
    if (scene.mesh == nullptr && scene.skeleton == nullptr && scene.cloud == nullptr && !copies)
        throw InvalidInput("render: there is nothing to draw");
    if (copies) check_copies(scene);
    if (scene.mesh != nullptr) {
        if (scene.mesh->face_count() == 0) throw InvalidInput("render: the mesh has no faces");
        for (const std::uint32_t v : scene.mesh->corners) {
            if (!is_finite(scene.mesh->positions[v])) {
                throw InvalidInput(fmt::format("render: vertex {} of the mesh has no finite position", v));
            }
        }
    }
    const std::uint32_t faces = scene.mesh == nullptr ? 0 : scene.mesh->face_count();
    for (const std::uint32_t f : scene.marked_faces) {
        if (f >= faces)
            throw InvalidInput(fmt::format("render: face {} is marked, but there are {}", f, faces));
    }
    if (scene.cloud != nullptr) check(*scene.cloud, scene.point_radius);
    for (const RenderMaterial& material : scene.materials) check(material, scene.mesh);
    if (!scene.face_materials.empty() &&
        (scene.mesh == nullptr || scene.face_materials.size() != scene.mesh->face_count()))
        throw InvalidInput("render: the number of materials of faces must be that of the faces");
    const bool has_other = scene.distance_to != nullptr && scene.distance_to->boxes().size() > 0;
    if (options.color == RenderColor::distance && scene.cloud != nullptr && scene.cloud->distances.empty() &&
        !has_other)
        throw InvalidInput(
            "render: colouring by distance requires points with distances, or a mesh with faces");
    if (options.color == RenderColor::distance && scene.cloud == nullptr &&
        (scene.mesh == nullptr || !has_other)) {
        throw InvalidInput("render: colouring by distance requires a mesh and another one with faces");
    }
    if (options.color == RenderColor::evidence &&
        (scene.skeleton == nullptr || scene.evidence.size() != scene.skeleton->size()))
        throw InvalidInput(
            "render: colouring by evidence requires a skeleton and an evidence value for each of its nodes");
    if (uses_values(scene, options.color) &&
        (scene.mesh == nullptr || scene.vertex_values.size() != scene.mesh->positions.size())) {
        throw InvalidInput(fmt::format(
            "render: colouring by {} requires {}a number for each vertex of a mesh", name_of(options.color),
            options.color == RenderColor::radius ? "a skeleton, or " : ""));
    }
    if (!scene.mesh_colors.empty() &&
        (scene.mesh == nullptr || scene.mesh_colors.size() != scene.mesh->positions.size()))
        throw InvalidInput("render: the number of colours must be that of the vertices of the mesh");
    if (!scene.skeleton_colors.empty() &&
        (scene.skeleton == nullptr || scene.skeleton_colors.size() != scene.skeleton->size()))
        throw InvalidInput("render: the number of colours must be that of the nodes of the skeleton");
    if (options.color != RenderColor::deviation) return;
    if (scene.mesh == nullptr || scene.deviation.size() != scene.mesh->positions.size()) {
        throw InvalidInput(
            "render: colouring by deviation requires a mesh and a deviation for each of its vertices");
    }
}

Image::Pixel encode(const Light& light) {
    if (light.alpha <= 0) return {0, 0, 0, 0};
    const auto [red, green, blue] = to_srgb(light.color / light.alpha);
    return {red, green, blue, static_cast<std::uint8_t>(std::lround(255 * std::min(1.0f, light.alpha)))};
}

/// [m] Returns the distances of points from the other surface.
std::vector<float> distances_to(const SurfaceTree& surface, std::size_t count, const Context& ctx,
                                const std::function<Vec3d(std::size_t)>& world) {
    constexpr std::size_t kGrain = 256;
    std::vector<float> out(count);
    const Vec3d origin = surface.mesh().origin;
    parallel_for(ctx, count, kGrain, [&](std::size_t i) {
        out[i] = static_cast<float>(surface.signed_distance(world(i) - origin));
    });
    return out;
}

/// Returns the distances of the vertices that faces use.
std::vector<float> distances_of_mesh(const PolygonMesh& mesh, const SurfaceTree& surface,
                                     const Context& ctx) {
    std::vector<std::uint32_t> used = mesh.corners;
    sort_unique(used);
    return distances_to(surface, used.size(), ctx,
                        [&](std::size_t i) { return Vec3d(mesh.positions[used[i]]) + mesh.origin; });
}

/// Returns the cloud with the colours of its distances; chooses their range if none is given.
PointCloud paint(const RenderScene& scene, float& range, const Context& ctx) {
    PointCloud out = *scene.cloud;
    if (out.distances.empty()) {
        out.distances = distances_to(*scene.distance_to, out.points.size(), ctx,
                                     [&](std::size_t i) { return out.points.world(i); });
    }
    if (range == 0) range = usual_range(out.distances);
    out.colors = distance_colors(out.distances, range);
    return out;
}

/// Polls the stop token in each row, because many samples make a tile slow.
void draw_tile(Image& image, const Shading& shading, int left, int top, int bottom,
               const std::stop_token& stop) {
    for (int y = top; y < bottom && !stop.stop_requested(); ++y) {
        for (int x = left; x < std::min(image.width, left + kTile); ++x)
            image.at(x, y) = encode(shading.pixel(x, y));
    }
}

/// Draws rings of at least a fortieth of the image, so that they remain visible.
void draw_marks(Image& image, const RenderScene& scene, const TracedScene& traced, const Camera& camera) {
    constexpr float kMinRadius = 1.0f / 80, kWidth = 1.0f / 450, kFree = 1.15f;
    const auto size = static_cast<float>(std::min(image.width, image.height));
    for (const RenderMark& mark : scene.marks) {
        const Vec3 place = traced.local(mark.place);
        const Camera::Projected middle = camera.project(place);
        if (middle.depth <= 0) continue;
        const auto rim = camera.project(place + camera.right() * (traced.local_length(mark.radius) * kFree));
        const float radius = std::max(std::hypot(rim.x - middle.x, rim.y - middle.y), kMinRadius * size);
        draw_ring(image, {middle.x, middle.y, radius, std::max(1.5f, kWidth * size)}, kMarkColor);
    }
}

/// Returns the labels of the scale of an attribute; that of radii is the same as without an attribute.
std::optional<ScaleLabels> value_labels(const ValueColors& values, RenderColor color) {
    const double min{values.min}, max{values.max}, middle = (min + max) / 2;
    if (color == RenderColor::along)
        return ScaleLabels{length_text(max), length_text(middle), length_text(min)};
    if (color != RenderColor::order) return std::nullopt;
    const auto text = [](double number) { return fmt::format("{:.3g}", number); };
    return ScaleLabels{text(max), text(middle), text(min)};
}

}  // namespace

Image render(const RenderScene& scene, const RenderOptions& options, const Context& ctx) {
    check(scene, options);
    ctx.throw_if_cancelled();
    ctx.report(0);
    RenderScene shown = scene;
    if (options.color == RenderColor::deviation || options.color == RenderColor::distance)
        shown.skeleton = nullptr;  // it would cover the coloured surface
    if (!has_drawn_copies(scene, options)) shown.instances = nullptr;
    RenderOptions chosen = options;
    RadiusColors radii;
    ValueColors values;
    if (uses_values(scene, options.color)) {
        values = value_colors(scene.vertex_values, choose_scale(options.color));
        shown.mesh_colors = values.colors;
        shown.skeleton = nullptr;
        radii.min = values.min;
        radii.max = values.max;
    } else if (options.color == RenderColor::radius) {
        radii = radius_colors(*scene.skeleton, scene.mesh, ctx);
        shown.mesh_colors = radii.vertices;
        shown.skeleton_colors = radii.nodes;
        if (scene.mesh != nullptr) shown.skeleton = nullptr;
    }
    PointCloud point_cloud;
    if (options.color == RenderColor::distance && scene.cloud != nullptr) {
        point_cloud = paint(scene, chosen.distance_range, ctx);
        shown.cloud = &point_cloud;
    } else if (options.color == RenderColor::distance && options.distance_range == 0) {
        chosen.distance_range = usual_range(distances_of_mesh(*scene.mesh, *scene.distance_to, ctx));
    }
    const TracedScene traced(shown, options, ctx);
    ctx.throw_if_cancelled();
    ctx.report(kBuildShare);
    std::optional<Vec3> middle;
    if (options.look_at) middle = traced.local(*options.look_at);
    const Camera camera = scene.view != nullptr
                              ? Camera(traced.local(*scene.view))
                              : Camera(traced.frame_points(), options.camera, options.zoom, middle);
    if (middle && scene.view == nullptr && camera.project(*middle).depth <= 0)
        throw InvalidInput(
            "render: the point of look_at is behind the camera; change the direction of the camera");
    std::vector<TracedMaterial> materials;
    if (options.color == RenderColor::plain) {
        for (const auto of : {scene.materials, scene.prototype_materials})
            for (const RenderMaterial& material : of) materials.emplace_back(material, ctx);
    }
    const Shading shading(traced, camera, chosen, materials);
    Image image(options.camera.width, options.camera.height);
    const int columns = (options.camera.width + kTile - 1) / kTile;
    for (int top = 0; top < options.camera.height; top += kRowsPerReport) {
        const int end = std::min(options.camera.height, top + kRowsPerReport);
        const int rows = (end - top + kTile - 1) / kTile;
        const auto tiles = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
        parallel_for(ctx, tiles, 1, [&](std::size_t i) {
            const int tile = static_cast<int>(i), y = top + tile / columns * kTile;
            draw_tile(image, shading, tile % columns * kTile, y, std::min(end, y + kTile), ctx.stop);
        });
        ctx.throw_if_cancelled();
        ctx.report(kBuildShare +
                   (1 - kBuildShare) * static_cast<float>(end) / static_cast<float>(options.camera.height));
    }
    draw_marks(image, scene, traced, camera);
    if (const auto labels = value_labels(values, options.color)) draw_scale_bar(image, *labels);
    if (options.color == RenderColor::radius)
        draw_scale_bar(image, {length_text(double{radii.max}),
                               length_text(std::sqrt(double{radii.min} * double{radii.max})),
                               length_text(double{radii.min})});
    if (options.color == RenderColor::deviation)
        draw_scale_bar(image, around_zero(fmt::format("{:.3g}%", 100 * options.deviation_range)));
    if (options.color == RenderColor::distance)
        draw_scale_bar(image, around_zero(length_text(chosen.distance_range)));
    if (options.color == RenderColor::evidence) draw_scale_bar(image, {"0%", "50%", "100%"});
    return image;
}

void list_fields(RenderOptions& o, FieldList& list) {
    list_fields(o.camera, list);
    list.add(Field{"samples", "Number of rays per pixel; more are slower and reduce the noise.", Unit::none,
                   1, 4096},
             o.samples);
    list.add(Field{"look_at",
                   "Point at the centre of the image, as 0.5,-2,13; by default the centre of the object.",
                   Unit::metre},
             o.look_at);
    list.add(common_field("zoom", "Magnification; 1 fits the whole object into the image.", Unit::none, 0.01,
                          10000),
             o.zoom);
    list.add(Field{"sun_azimuth", "Direction of the sun, counter-clockwise from the camera.", Unit::radian,
                   -6.2832, 6.2832},
             o.sun_azimuth);
    list.add(Field{"sun_elevation", "Height of the sun above the horizon.", Unit::radian, 0.05, 1.5708},
             o.sun_elevation);
    list.add(
        common_field("color",
                     "Colour of the surface: plain, magenta for overlays (signal), or a quantity: "
                     "deviation and distance are blue inside and red outside, evidence is blue where radii "
                     "were measured and red where they were estimated, radius is blue where branches are "
                     "thin and red where they are thick; order, branch and along, the distance from the "
                     "beginning of the branch, are numbers that coppice mesh --attributes writes."),
        o.color);
    list.add(Field{"deviation_range", "Deviation from the radius that has the full colour.", Unit::radius,
                   1e-4, 10},
             o.deviation_range);
    list.add(Field{"distance_range",
                   "Distance that has the full colour; 0 uses the 98 % quantile over the vertices or points.",
                   Unit::metre, 0, 1e6},
             o.distance_range);
    list.add(common_field("wireframe", "Draw the edges of the faces."), o.wireframe);
    list.add(Field{"wire_width", "Width of the edges in pixels.", Unit::none, 0.2, 20}, o.wire_width);
    list.add(Field{"flat", "Show faces flat, without smoothing across edges."}, o.flat);
    list.add(Field{"ground", "Draw a ground that receives the shadow."}, o.ground);
    list.add(Field{"transparent", "Leave the background transparent."}, o.transparent);
    list.add(
        Field{"axis_width", "Thickness of a skeleton that is visible through a mesh.", Unit::radius, 0.01, 1},
        o.axis_width);
}

}  // namespace coppice
