#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <utility>

#include "command.h"
#include "coppice/io_mesh/solid_writer.h"
#include "coppice/io_mesh/writer.h"
#include "coppice/io_points/reader.h"
#include "coppice/mesh/half_edges.h"
#include "coppice/pipeline/displace.h"
#include "coppice/pipeline/face_budget.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/restore.h"
#include "coppice/system/file.h"
#include "figures.h"
#include "files.h"
#include "options.h"
#include "pictures.h"
#include "results.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

struct MeshFlags {
    std::filesystem::path skeleton, cage, volume, constraints, original, offsets;
    std::vector<std::filesystem::path> outputs;
    MeshOptions mesh = options_of_written_surface();
    RestoreOptions restore;
    ReadSkeletonOptions read;
    MeshWriteOptions write;
    std::filesystem::path heights;
    MaterialPrefixes materials;
    DisplaceOptions displace;
    FaceNumber number;
    bool constraint_edges = false;
    bool strict = false;
};

bool makes_quads(MeshMethod method) {
    return method != MeshMethod::tetrahedra && method != MeshMethod::cylinders;
}

bool writes_one_of(const MeshFlags& flags, std::initializer_list<MeshFormat> formats) {
    return std::ranges::any_of(flags.outputs, [&](const auto& output) {
        const auto format = mesh_format_of_name(output);
        return format && std::ranges::find(formats, *format) != formats.end();
    });
}

void check_volume(const MeshFlags& flags) {
    if (flags.mesh.method != MeshMethod::tetrahedra)
        throw UsageError("--volume requires --method tetrahedra");
    if (flags.mesh.fit == Fit::volume) throw UsageError("--volume requires --fit surface");
    if (!solid_format_of_name(flags.volume)) {
        throw UsageError(fmt::format("--volume writes VTU and Gmsh; use the extension .vtu or .msh for '{}'",
                                     flags.volume.string()));
    }
    check_output_folder(flags.volume);
}

void check_material(const MeshFlags& flags) {
    check_materials(flags.materials);
    if (flags.materials.bark.empty()) return;
    if (!writes_one_of(flags, {MeshFormat::glb, MeshFormat::obj, MeshFormat::usda}))
        throw UsageError("--material requires a .glb, .obj or .usda output; none of the outputs is one");
}

void check_displacement(const MeshFlags& flags) {
    if (flags.mesh.texture.coordinates != TextureCoordinates::bark)
        throw UsageError("--displace requires --uv bark");
    if (flags.mesh.method == MeshMethod::cylinders)
        throw UsageError("--displace does not apply to --method cylinders, which intersect each other");
    if (!flags.volume.empty())
        throw UsageError("--displace does not move the tetrahedra of --volume; leave one of them out");
}

/// Throws UsageError if no output has the values of vertices that an option adds.
void check_vertex_values(const MeshFlags& flags, std::string_view option) {
    if (writes_one_of(flags, {MeshFormat::glb, MeshFormat::ply, MeshFormat::usda})) return;
    throw UsageError(
        fmt::format("{} requires a .glb, .ply or .usda output; none of the outputs is one", option));
}

void check_flags(const MeshFlags& flags) {
    if (flags.skeleton.empty() || (flags.outputs.empty() && flags.cage.empty() && flags.volume.empty())) {
        throw UsageError("name the skeleton and the mesh: coppice mesh SKELETON -o MESH");
    }
    for (const auto& output : flags.outputs) check_mesh_output(output);
    check_mesh_write_options(flags.write, flags.outputs);
    if (!flags.constraints.empty() && flags.mesh.field.weights != Weights::global) {
        throw UsageError("--constraints requires --weights global");
    }
    if (flags.constraint_edges && flags.constraints.empty())
        throw UsageError("--constraint-edges requires --constraints MESH");
    if (!flags.original.empty() && !makes_quads(flags.mesh.method)) {
        throw UsageError("--restore requires --method quads");
    }
    if (!flags.offsets.empty()) {
        if (flags.original.empty()) throw UsageError("--offsets requires --restore MESH");
        check_output_folder(flags.offsets);
    }
    if (!flags.volume.empty()) check_volume(flags);
    check_material(flags);
    if (flags.mesh.texture.blend) check_vertex_values(flags, "--uv-blend");
    if (!flags.heights.empty()) check_displacement(flags);
    if (flags.mesh.attributes) check_vertex_values(flags, "--attributes");
    if (flags.cage.empty()) return;
    if (!makes_quads(flags.mesh.method)) throw UsageError("--cage requires --method quads");
    check_mesh_output(flags.cage);
    if (mesh_format_of_name(flags.cage) != MeshFormat::usda) {
        throw UsageError(
            fmt::format("--cage writes USDA; use the extension .usda for '{}'", flags.cage.string()));
    }
}

/// Throws UsageError for options that have no effect.
void check_given(const GivenOptions& given, const MeshOptions& mesh, int faces) {
    const auto has = [&](std::string_view name) { return is_given(given, name); };
    const bool bmesh = mesh.method == MeshMethod::bmesh;
    check_texture(given, mesh.texture);
    if (has("--uv-blend") && mesh.method == MeshMethod::cylinders)
        throw UsageError("--uv-blend does not apply to --method cylinders, which intersect each other");
    if (has("--twig-material") && mesh.method == MeshMethod::cylinders)
        throw UsageError("--twig-material does not apply to --method cylinders, which intersect each other");
    for (const std::string_view name : {"--displace-height", "--displace-share"}) {
        if (has(name) && !has("--displace")) throw UsageError(fmt::format("{} requires --displace", name));
    }
    if (has("--ball-bulge") && !bmesh && mesh.field.kernel != Kernel::balls)
        throw UsageError("--ball-bulge requires --method bmesh");
    if (has("--blend") && bmesh)
        throw UsageError(
            "--method bmesh adds the fields of all balls; leave --blend out, or use --kernel balls for it");
    if (has("--tetra-base") && mesh.method != MeshMethod::tetrahedra)
        throw UsageError("--tetra-base requires --method tetrahedra");
    if (has("--device") && mesh.method == MeshMethod::cylinders)
        throw UsageError("--device applies to surfaces of a field; leave it out with --method cylinders");
    if (faces > 0 && has("--levels")) throw UsageError("--faces chooses the levels; leave --levels out");
    if (faces > 0 && has("--chord-error"))
        throw UsageError("--faces chooses the chord error; leave --chord-error out");
    if (has("--tetra-levels") && mesh.tetra.base == TetraBase::polyhedron)
        throw UsageError(
            "--tetra-levels applies to an octree; with --tetra-base polyhedron use --tetra-edge");
}

/// Writes one number per line, in the order of the vertices.
void write_offsets(const std::filesystem::path& path, std::span<const float> offsets) {
    AtomicFile file(path);
    for (const float offset : offsets) file.write(fmt::format("{}\n", offset));
    file.commit();
}

/// Moves the surface back to the original mesh; returns a summary.
std::string restore(Run& run, const MeshFlags& flags, const PolygonMesh& original, const Skeleton& skeleton,
                    QuadMesh& mesh) {
    const RestoreResult result = run.stage("restore", [&](const Context& ctx) {
        return restore_offsets(mesh, original, skeleton, flags.restore, ctx);
    });
    if (result.report.found == 0) {
        throw InvalidInput(
            fmt::format("no face of '{}' is within --restore-reach of the surface with a similar normal; is "
                        "it in the skeleton's units and coordinates?",
                        flags.original.string()));
    }
    run.counts()["restored"] = compute_figures(result.report);
    if (!flags.offsets.empty()) write_offsets(flags.offsets, result.offsets);
    return fmt::format("; {} restored, {} held back", grouped(result.report.found),
                       grouped(result.report.pulled_back));
}

/// Moves the surface by heights; returns a summary.
std::string displace(Run& run, const MeshFlags& flags, const HeightTexture& heights, const Skeleton& skeleton,
                     MeshResult& result) {
    const DisplaceReport report = run.stage("displace", [&](const Context& ctx) {
        return displace_surface(result, skeleton, heights, flags.displace, ctx);
    });
    run.counts()["displaced"] = compute_figures(report);
    return fmt::format("; displaced by up to {:.2g} mm, {:.2g} mm on average, {} held back, volume {:+.2f} %",
                       1e3 * report.max_offset, 1e3 * report.mean_offset, grouped(report.pulled_back),
                       100 * (report.volume_after / report.volume_before - 1));
}

/// Returns the vertices of a mesh, and if requested the midpoints of its edges, with the end points of the
/// edges.
PointSet points_of_mesh(const PolygonMesh& mesh, bool edges) {
    PointSet out{mesh.positions, mesh.origin};
    if (!edges) return out;
    const HalfEdges half_edges(mesh);
    for (std::uint32_t e = 0; e < half_edges.edge_count(); ++e) {
        const auto [a, b] = half_edges.ends(e);
        out.positions.push_back((mesh.positions[a] + mesh.positions[b]) * 0.5f);
    }
    return out;
}

PointSet load_constraints(Run& run, const MeshFlags& flags) {
    if (flags.constraints.empty()) return {};
    if (kind_of_input(run, flags.constraints) == FileKind::mesh)
        return points_of_mesh(load_mesh(run, flags.constraints, flags.read.up), flags.constraint_edges);
    if (flags.constraint_edges)
        throw UsageError(
            fmt::format("--constraint-edges needs a mesh; '{}' has no edges", flags.constraints.string()));
    return load_points(run, flags.constraints, flags.read.up);
}

/// Reports the result of the planning, and returns a summary.
std::string tell_plan(Run& run, const MeshFlags& flags, const BudgetedMesh& made) {
    const FaceBudget& budget = made.budget;
    run.counts()["faces"] = {{"wanted", flags.number.faces},
                             {"levels", budget.options.levels},
                             {"chord_error", budget.options.chord_error},
                             {"axes", budget.axes},
                             {"dropped_axes", budget.dropped},
                             {"dropped_silhouette", budget.dropped_silhouette}};
    const std::string missed = text_of_missed_faces(made, static_cast<std::uint64_t>(flags.number.faces));
    if (!missed.empty()) run.warn(missed);
    return "; " + to_text(budget);
}

/// A surface, the branches that it was made from (if not all), and a summary of that.
struct MadeMesh {
    MeshResult result;
    std::optional<Skeleton> drawn;
    std::string planned;
};

MadeMesh make_surface(Run& run, const MeshFlags& flags, const Skeleton& skeleton,
                      const PointSet& constraints) {
    if (flags.number.faces > 0) {
        const auto faces = static_cast<std::uint64_t>(flags.number.faces);
        BudgetedMesh made = run.stage("mesh", [&](const Context& ctx) {
            return mesh_with_faces(skeleton, constraints, flags.mesh, faces, ctx);
        });
        std::string planned = tell_plan(run, flags, made);
        return {std::move(made.result), std::move(made.budget.skeleton), std::move(planned)};
    }
    return {run.stage("mesh",
                      [&](const Context& ctx) {
                          return flags.volume.empty() ? mesh_skeleton(skeleton, constraints, flags.mesh, ctx)
                                                      : mesh_solid(skeleton, constraints, flags.mesh, ctx);
                      }),
            {},
            {}};
}

/// Returns the image with the extent of the tiles: the colour of the bark, or else the heights.
std::filesystem::path find_tiled_image(const MeshFlags& flags, const MeshWriteOptions& write) {
    if (!write.materials.empty()) return write.materials.front().color;
    return flags.heights.empty() ? std::filesystem::path() : height_file(flags.heights);
}

ExitCode mesh(Run& run, const GivenOptions& given, MeshFlags flags) {
    check_flags(flags);
    check_given(given, flags.mesh, flags.number.faces);
    MeshWriteOptions write = flags.write;
    write.materials = find_materials(flags.materials);
    flags.mesh.slots = make_slots(flags.materials, flags.mesh.slots);
    const SkeletonFile file = load_skeleton(run, flags.skeleton, flags.read);
    const PointSet constraints = load_constraints(run, flags);
    PolygonMesh original;
    if (!flags.original.empty()) original = load_mesh(run, flags.original, flags.read.up);
    HeightTexture heights;
    if (!flags.heights.empty()) heights = load_heights(run, flags.heights, flags.displace.displace_height);
    std::string moved = use_tile_of_image(run, given, find_tiled_image(flags, write), flags.mesh.texture);
    MadeMesh made = make_surface(run, flags, file.skeleton, constraints);
    MeshResult& result = made.result;
    run.add_stages("mesh: ", result.stages);
    if (!flags.original.empty()) moved += restore(run, flags, original, file.skeleton, result.quads().mesh);
    const Skeleton& drawn = made.drawn ? *made.drawn : file.skeleton;
    if (!flags.heights.empty()) moved += displace(run, flags, heights, drawn, result);
    run.stage("write", [&](const Context& ctx) {
        for (const auto& output : flags.outputs) store_surface(run, output, result, write, ctx);
        if (!flags.volume.empty()) write_solid(flags.volume, result.tetrahedra().solid, ctx);
        if (!flags.cage.empty()) write_cage(flags.cage, result.quads().cage.cage, ctx);
    });
    if (result.weights) run.counts().update(compute_figures(*result.weights));
    const bool is_judged = flags.original.empty() && (flags.strict || !is_held_only(run, flags.outputs));
    const Verdict verdict = is_judged ? judge(run, result, drawn, flags.mesh.control) : Verdict{};
    const std::string figures = count_surface(run, result);
    warn_of_lost_materials(run, flags.materials, flags.outputs);
    run.finish(fmt::format("{}: {} nodes, {} repaired; {}{}{}{}", flags.skeleton.string(),
                           grouped(file.skeleton.size()), grouped(file.report.total()), figures, verdict.text,
                           made.planned, moved));
    return flags.strict && !verdict.is_good ? kCheckFailed : kDone;
}

}  // namespace

FlagNames surface_flag_names(const std::optional<MemberNames>& common) {
    return {.names = {{"project.method", "--project-method"}, {"project.tolerance", "--project-tolerance"}},
            .common = common};
}

FlagNames then_mesh_flag_names() {
    FlagNames surface = surface_flag_names(MemberNames{});
    surface.names.insert(
        surface.names.end(),
        {{"method", "--mesh-method"}, {"fit", "--mesh-fit"}, {"prepare.tolerance", "--prepare-tolerance"}});
    return surface;
}

Command mesh_command() {
    const auto flags = std::make_shared<MeshFlags>();
    OptionList options;
    options.file("skeleton", "SKELETON", flags->skeleton,
                 "Skeleton to read (.swc, .csv, .txt, .mat, .ply, .obj, .json, .rsml, .mtg).");
    options.outputs("-o,--output", "MESH", flags->outputs,
                    "Mesh to write (.ply, .obj, .glb, .stl, .usda); may be repeated.");
    options.output("--cage", "FILE", flags->cage,
                   "Also write the control cage, for subdivision in other programs (.usda).",
                   {.common = false});
    options.output("--volume", "FILE", flags->volume,
                   "Also write the tetrahedra inside the surface, for finite elements (.vtu, .msh).",
                   {.common = false});
    options.file("--constraints", "POINTS", flags->constraints,
                 "Points, or a mesh with vertices, to which global weights are fitted (.xyz, .ply, .obj).",
                 {.common = false});
    options.flag("--constraint-edges", flags->constraint_edges,
                 "Also fit global weights to the midpoints of the edges of that mesh.", {.common = false});
    options.file("--restore", "MESH", flags->original,
                 "Move the surface onto this mesh where it is near (.ply, .obj, .off, .stl, .glb).",
                 {.common = false});
    options.output("--offsets", "FILE", flags->offsets,
                   "Also write the distance by which --restore moved each vertex along its normal, in "
                   "metres, one per line.",
                   {.common = false});
    options.flag("--strict", flags->strict,
                 "Exit with 1 if the surface does not represent the whole skeleton; see coppice check.",
                 {.common = false});
    options.fields(flags->number, "Surface");
    options.fields(flags->mesh, "Surface", surface_flag_names());
    options.fields(flags->mesh.texture, "Texture");
    add_material_options(options, flags->materials, {.common = false});
    options.fields(flags->mesh.slots, "Texture", {.common = MemberNames{}});
    options.file("--displace", "PREFIX", flags->heights,
                 "Displace the surface by the heights of the image PREFIX_height.png, as made by coppice "
                 "texture, without folds and intersections.",
                 {.group = "Texture", .common = false});
    options.fields(flags->displace, "Texture");
    options.flag("--attributes", flags->mesh.attributes,
                 "Also write the order and the number of the branch, the distance along it and its radius at "
                 "every vertex, to .glb, .ply and .usda.",
                 {.group = "Texture", .common = false});
    options.fields(flags->restore, "Restoring the original", {.names = {{"reach", "--restore-reach"}}});
    options.fields(flags->read, "Reading the skeleton");
    add_mesh_write_options(options, flags->write);
    return {"mesh", "Turn a skeleton with radii into one closed surface of quads or triangles.", options,
            [flags](Run& run, const GivenOptions& given) { return mesh(run, given, *flags); },
            ManyFiles{mesh_command, "skeleton", ".ply", {FileKind::skeleton}}};
}

}  // namespace coppice::cli
