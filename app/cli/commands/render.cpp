#include "coppice/render/render.h"

#include <fmt/format.h>

#include <algorithm>

#include "command.h"
#include "coppice/base/fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/io_sketch/sketch_file.h"
#include "coppice/measure/intersections.h"
#include "coppice/measure/radius.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/mesh/topology.h"
#include "coppice/points/spacing.h"
#include "coppice/render/picture.h"
#include "coppice/render/png.h"
#include "coppice/scene/drawn_material.h"
#include "coppice/system/file.h"
#include "drawn_objects.h"
#include "files.h"
#include "options.h"
#include "pictures.h"
#include "results.h"
#include "surfaces.h"

namespace coppice::cli {

/// Highlighted elements in the image of a mesh.
enum class Marked { none, crossings };

}  // namespace coppice::cli

namespace coppice {

template <>
struct EnumNames<cli::Marked> {
    static constexpr std::array<std::string_view, 2> names{"none", "crossings"};
};

}  // namespace coppice

namespace coppice::cli {
namespace {

struct RenderFlags {
    std::vector<std::filesystem::path> inputs;
    std::filesystem::path output, distance_to, over;
    std::filesystem::path camera;  ///< SKETCH:VIEW
    MaterialPrefixes materials;
    float opacity = 0.7f;  ///< opacity of the objects drawn over a photograph
    Marked mark = Marked::none;
    float point_size = 0;  ///< [m] width of points; 0 = derived from their spacing
    RenderOptions render;
    ReadSkeletonOptions read;
    ReadPointsOptions read_points;
};

struct Inputs : DrawnObjects {
    float point_radius = 0;  ///< [m]
    std::optional<PolygonMesh> other;
    std::optional<SurfaceTree> surface;  ///< index of the other mesh
};

/// Highlighted elements.
struct Crossings {
    std::vector<std::uint32_t> faces;
    std::vector<RenderMark> places;
};

/// [m] Returns the requested radius, or else half of the point spacing, but at least the size that is visible
/// in the image.
float point_radius(Run& run, const PointSet& points, const RenderFlags& flags) {
    if (flags.point_size > 0) return flags.point_size / 2;
    const double spacing =
        run.stage("points", [&](const Context& ctx) { return median_spacing(points, ctx); });
    constexpr double kSeen = 1.0 / 400;  // fraction of the diagonal: about two pixels
    const double least = std::max(kSeen * double{bounds(points).diagonal()}, 1e-6);
    return static_cast<float>(std::max(spacing, least) / 2);
}

/// Returns the numbers of vertices that a colour shows; empty if it shows none.
std::string find_attribute(RenderColor color) {
    switch (color) {
        case RenderColor::order:
        case RenderColor::branch:
        case RenderColor::radius:
            return std::string(name_of(color));
        case RenderColor::along:
            return "distance";
        case RenderColor::plain:
        case RenderColor::signal:
        case RenderColor::deviation:
        case RenderColor::distance:
        case RenderColor::evidence:
            break;
    }
    return {};
}

Inputs load(Run& run, const RenderFlags& flags, RenderColor color) {
    Inputs in{load_drawn_objects(run, flags.inputs, find_attribute(color), flags.read, flags.read_points),
              0,
              {},
              {}};
    if (in.skeleton && color == RenderColor::radius) in.vertex_values.clear();  // the skeleton has radii
    if (in.cloud) in.point_radius = point_radius(run, in.cloud->points, flags);
    return in;
}

void check_flags(const RenderFlags& flags) {
    if (flags.inputs.empty() || flags.output.empty())
        throw UsageError("name the files: coppice render IN... -o PNG");
    check_picture_output(flags.output);
}

/// Loads the mesh from which distances are measured; the surface refers to it.
void load_other(Run& run, const RenderFlags& flags, Inputs& in) {
    if (!in.mesh && !in.cloud)
        throw UsageError(
            "--distance-to requires a mesh or points to draw: coppice render MESH --distance-to OTHER -o "
            "PNG");
    in.other = load_mesh(run, flags.distance_to, flags.read.up);
    if (in.cloud) in.cloud->distances.clear();  // replaced by the distances from this mesh
    in.surface = run.stage("index", [&](const Context& ctx) {
        validate(*in.other);
        return SurfaceTree(*in.other, ctx);
    });
}

Crossings find_crossings(Run& run, const Inputs& in) {
    constexpr std::uint32_t kMaxPairs = 1'000'000;
    constexpr std::size_t kMaxPlaces = 1000;
    if (!in.mesh)
        throw UsageError("--mark crossings requires a mesh: coppice render MESH --mark crossings -o PNG");
    return run.stage("crossings", [&](const Context& ctx) {
        Crossings out;
        const FacePairs found = crossing_faces(SurfaceTree(*in.mesh, ctx), kMaxPairs, ctx);
        for (const FacePair& p : found.pairs) out.faces.insert(out.faces.end(), {p.first, p.second});
        const CrossingPlaces places = crossing_places(found, *in.mesh, nullptr, nullptr, kMaxPlaces, ctx);
        for (const CrossingPlace& p : places.largest) out.places.push_back({p.place, p.radius});
        run.counts()["crossings"] = found.pairs.size();
        run.counts()["crossing_places"] = places.total;
        return out;
    });
}

/// Returns the view that --camera SKETCH:VIEW names.
SketchView load_view(Run& run, const std::string& named) {
    const std::size_t colon = named.rfind(':');
    if (colon == std::string::npos || !is_sketch_name(named.substr(0, colon))) {
        throw UsageError(fmt::format(
            "'{}' does not name a camera; write the sketch and its view, as in tree.sketch.json:front",
            named));
    }
    const std::string file = named.substr(0, colon), name = named.substr(colon + 1);
    const std::vector<SketchView> views = run.stage("read", [&](const Context& ctx) {
        // Views without a calibrated camera derive it from the strokes.
        const SketchCameras cameras = read_cameras(file, ctx);
        const bool measured =
            std::ranges::none_of(cameras.snapshots, [](const auto& s) { return s.has_value(); });
        return measured ? cameras.views : read_sketch(file, ctx).views;
    });
    std::vector<std::string> names;
    for (const SketchView& view : views) {
        if (view.name == name) return view;
        names.push_back(view.name);
    }
    throw UsageError(fmt::format("'{}' has no view '{}'; it has {}", file, name, fmt::join(names, ", ")));
}

/// Loads the photograph of a camera, if any, and derives the settings of the rendering from it.
struct Backdrop {
    std::optional<SketchView> view;
    std::optional<Image> photograph;
};

Backdrop load_backdrop(Run& run, const RenderFlags& flags, RenderOptions& options) {
    Backdrop out;
    if (flags.camera.empty()) {
        if (flags.over.empty()) return out;
        throw UsageError("--over requires the camera of the image: --camera tree.sketch.json:front");
    }
    if (options.look_at || options.zoom != 1)
        throw UsageError("--camera defines the view; leave --look-at and --zoom out");
    out.view = load_view(run, flags.camera.string());
    if (out.view->width > 0 && out.view->height > 0) {
        options.camera.width = out.view->width;
        options.camera.height = out.view->height;
    }
    if (flags.over.empty()) return out;
    out.photograph = run.stage("read", [&](const Context& ctx) {
        return decode_picture(read_file(flags.over, kLargestFile, ctx), flags.over.string());
    });
    const Image& picture = *out.photograph;
    if (out.view->width > 0 && (picture.width != out.view->width || picture.height != out.view->height)) {
        throw InvalidInput(fmt::format("{}: the image has {} x {} pixels, but that of the view '{}' {} x {}",
                                       flags.over.string(), picture.width, picture.height, out.view->name,
                                       out.view->width, out.view->height));
    }
    if (options.color == RenderColor::plain) options.color = RenderColor::signal;
    options.camera.width = picture.width;
    options.camera.height = picture.height;
    options.ground = false;
    options.transparent = true;
    return out;
}

/// Gives the faces of groups that have the name of a material, as in the file of the mesh, that material.
void set_material(const PolygonMesh& mesh, const std::string& name, std::uint32_t material,
                  std::vector<std::uint32_t>& of_face) {
    bool is_found = false;
    for (std::size_t f = 0; f < mesh.group.size(); ++f) {
        const std::string& group = mesh.group_names[mesh.group[f]];
        if (group != name && !group.ends_with('/' + name)) continue;
        of_face[f] = material;
        is_found = true;
    }
    if (!is_found) {
        throw UsageError(fmt::format(
            "the mesh has no faces with the material '{}'; coppice mesh --material BARK --twig-material TWIG "
            "--cut-material CUT writes them to .glb and .obj",
            name));
    }
}

/// Loads the materials of the mesh, if any.
FaceMaterials load_mesh_materials(Run& run, const RenderFlags& flags, const Inputs& in, RenderColor color) {
    check_materials(flags.materials);
    if (flags.materials.bark.empty()) return {};
    if (color != RenderColor::plain || !flags.distance_to.empty())
        throw UsageError("--material defines the colours; leave --color, --distance-to and --over out");
    if (in.mesh_count != 1)
        throw UsageError("--material requires one mesh: coppice render MESH --material PREFIX -o PNG");
    if (in.mesh->texture.empty()) {
        throw UsageError(
            "--material requires a mesh with texture coordinates; write it by coppice mesh TREE --uv bark -o "
            "MESH.obj");
    }
    const std::vector<MaterialFiles> files = find_materials(flags.materials);
    std::vector<std::uint32_t> of_face(in.mesh->face_count(), 0);
    for (std::uint32_t m = 1; m < files.size(); ++m) {
        if (!files[m].empty()) set_material(*in.mesh, files[m].name, m, of_face);
    }
    return run.stage("read", [&](const Context& ctx) { return load_face_materials(files, of_face, ctx); });
}

ExitCode render_file(Run& run, const RenderFlags& flags) {
    check_flags(flags);
    RenderOptions options = flags.render;
    const Backdrop backdrop = load_backdrop(run, flags, options);
    Inputs in = load(run, flags, options.color);
    const FaceMaterials materials = load_mesh_materials(run, flags, in, options.color);
    if (!flags.distance_to.empty()) {
        load_other(run, flags, in);
        options.color = RenderColor::distance;
    }
    if (options.color == RenderColor::distance && flags.distance_to.empty() &&
        (!in.cloud || in.cloud->distances.empty())) {
        throw UsageError(
            "--color distance requires another mesh, or points with distances: coppice render MESH "
            "--distance-to OTHER -o PNG");
    }
    const bool by_deviation = options.color == RenderColor::deviation;
    if (by_deviation && !(in.mesh && in.skeleton)) {
        throw UsageError(
            "--color deviation requires a mesh and its skeleton: coppice render MESH SKELETON -o PNG");
    }
    const std::string attribute = find_attribute(options.color);
    const bool has_radii = options.color == RenderColor::radius && in.skeleton;
    if (!attribute.empty() && in.vertex_values.empty() && !has_radii) {
        throw UsageError(fmt::format(
            "--color {} requires {}a .glb or .ply mesh with the attribute '{}' of vertices: coppice mesh "
            "SKELETON --attributes -o MESH.glb",
            name_of(options.color),
            options.color == RenderColor::radius ? "a skeleton (coppice render MESH SKELETON -o PNG), or "
                                                 : "",
            attribute));
    }
    if (options.color == RenderColor::evidence && in.evidence.empty()) {
        throw UsageError(
            "--color evidence requires a skeleton with evidence, as coppice extract CLOUD writes it to .json "
            "and .ply: coppice render TREE.json --color evidence -o PNG");
    }
    std::vector<float> deviation;
    if (by_deviation) {
        deviation = run.stage(
            "measure", [&](const Context& ctx) { return vertex_deviations(*in.mesh, *in.skeleton, ctx); });
    }
    const Crossings crossings = flags.mark == Marked::crossings ? find_crossings(run, in) : Crossings{};
    const RenderScene scene{.mesh = in.mesh ? &*in.mesh : nullptr,
                            .materials = materials.materials,
                            .face_materials = materials.of_face,
                            .cloud = in.cloud ? &*in.cloud : nullptr,
                            .point_radius = in.point_radius,
                            .skeleton = in.skeleton ? &*in.skeleton : nullptr,
                            .deviation = deviation,
                            .vertex_values = in.vertex_values,
                            .evidence = in.evidence,
                            .mesh_colors = in.mesh_colors,
                            .skeleton_colors = in.skeleton_colors,
                            .marked_faces = crossings.faces,
                            .marks = crossings.places,
                            .distance_to = in.surface ? &*in.surface : nullptr,
                            .view = backdrop.view ? &*backdrop.view : nullptr};
    Image image = run.stage("render", [&](const Context& ctx) { return render(scene, options, ctx); });
    if (backdrop.photograph) image = overlay(*backdrop.photograph, image, flags.opacity);
    run.stage("write", [&](const Context&) { store_picture(run, flags.output, image); });
    run.counts()["pixels"] = image.pixels.size();
    run.finish(fmt::format("{}: {} x {} pixels", flags.output.string(), image.width, image.height));
    return kDone;
}

}  // namespace

Command render_command() {
    const auto flags = std::make_shared<RenderFlags>();
    OptionList options;
    options.files("inputs", "IN", flags->inputs,
                  "Meshes, points and skeletons to draw; several of a kind have different colours.");
    options.output("-o,--output", "PNG", flags->output, "Image to write (.png).");
    options.file("--distance-to", "MESH", flags->distance_to,
                 "Colour the points, or without points the mesh, by the distance from this mesh: inside "
                 "blue, outside red.");
    add_material_options(options, flags->materials);
    options.file("--camera", "SKETCH:VIEW", flags->camera,
                 "Camera of a view of a sketch, as tree.sketch.json:front; by default the object is framed.",
                 {.common = false});
    options.file("--over", "PHOTO", flags->over,
                 "Draw in magenta over this image (.png, .jpg), which the camera recorded.",
                 {.common = false});
    options.value(
        {{"opacity", "Opacity of the objects drawn over an image.", Unit::none, 0, 1}, &flags->opacity},
        "Picture");
    options.value(
        {{"mark", "Highlighted elements; crossings are intersecting faces of the mesh, marked by rings."},
         choice_of(flags->mark)},
        "Picture");
    options.value(
        {{"point_size",
          "Width of the points of a cloud; 0 derives it from their spacing and the size of the image.",
          Unit::metre, 0, 1e6},
         &flags->point_size},
        "Picture");
    options.fields(flags->render, "Picture");
    options.fields(flags->read, "Reading a skeleton", {.common = MemberNames{}});
    options.fields(flags->read_points, kReadPointsGroup);
    return {
        "render", "Draw meshes, points and skeletons with sun and sky light.", options,
        [flags](Run& run, const GivenOptions&) { return render_file(run, *flags); },
        ManyFiles{render_command, "inputs", ".png", {FileKind::skeleton, FileKind::mesh, FileKind::points}}};
}

}  // namespace coppice::cli
