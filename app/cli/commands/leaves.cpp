#include <fmt/format.h>

#include <memory>

#include "command.h"
#include "coppice/base/quote.h"
#include "coppice/foliage/leaf_species.h"
#include "coppice/io_mesh/writer.h"
#include "coppice/options/spelling.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/render/render.h"
#include "coppice/scene/drawn_material.h"
#include "coppice/scene/surface_leaves.h"
#include "files.h"
#include "leaf_pictures.h"
#include "options.h"
#include "pictures.h"
#include "results.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

struct LeavesFlags {
    std::filesystem::path skeleton, species, image;
    std::vector<std::filesystem::path> outputs;
    int models = 3;
    LeafShape shape;
    LeafRules rules;
    BranchletOptions branchlets;
    OrganOptions organs;
    MeshOptions mesh = options_of_written_surface();
    MaterialPrefixes materials;
    InstanceStorage storage = InstanceStorage::instanced;
    MeshWriteOptions write;
    RenderOptions render;
    ReadSkeletonOptions read;
};

/// Prints the species with their leaves.
ExitCode list_species(Run& run) {
    std::string text = fmt::format("{:<15} {:<12} {:<13} {:>6} {:>6} {:>9}  {}\n", "species", "arrangement",
                                   "outline", "cm", "wide", "internode", "description");
    Json figures = Json::array();
    for (const LeafSpecies& s : leaf_species()) {
        text += fmt::format(
            "{:<15} {:<12} {:<13} {:>6.3g} {:>6.3g} {:>9.3g}  {}\n", s.name, name_of(s.rules.arrangement),
            s.shape.parts == LeafParts::needles ? name_of(s.shape.parts) : name_of(s.shape.outline),
            100 * double{s.shape.length}, 100 * double{s.shape.width}, 100 * double{s.rules.internode},
            s.title);
        figures.push_back({{"species", s.name}, {"description", s.title}});
    }
    run.print(text);
    run.counts()["species"] = figures;
    run.finish(fmt::format("{} species", leaf_species().size()));
    return kDone;
}

LeafSpecies find_species(const std::string& name) {
    if (const auto found = find_leaf_species(name)) return *found;
    std::vector<std::string> names;
    for (const LeafSpecies& species : leaf_species()) names.emplace_back(species.name);
    throw UsageError(fmt::format("there are no leaves of {}{}; coppice leaves lists the species", quote(name),
                                 did_you_mean(name, names)));
}

/// Returns the leaves of the species with the options of the command line.
LeafSpecies make_species(const LeavesFlags& flags, const GivenOptions& given) {
    LeafSpecies species = find_species(flags.species.string());
    LeafShape shape = flags.shape;
    LeafRules rules = flags.rules;
    copy_given(option_fields(shape), option_fields(species.shape), given);
    copy_given(option_fields(rules), option_fields(species.rules), given);
    return species;
}

/// Writes the image of the tree.
void write_image(Run& run, const LeavesFlags& flags, const MeshResult& wood, const SurfaceLeaves& leaves) {
    PolygonMesh mesh = to_polygons(wood);
    if (wood.texture) mesh.texture.assign(wood.texture->points.begin(), wood.texture->points.end());
    const FaceMaterials bark = run.stage("read images", [&](const Context& ctx) {
        return load_face_materials(flags.write.materials, wood.slots, ctx);
    });
    write_leafed_picture(run, flags.image, mesh, bark, &leaves, flags.render);
}

void write_tree(Run& run, const LeavesFlags& flags, const MeshResult& wood,
                const std::shared_ptr<const SurfaceLeaves>& leaves) {
    MeshWriteOptions write = flags.write;
    write.parts = leaves->parts(flags.storage);
    run.stage("write", [&](const Context& ctx) {
        for (const auto& output : flags.outputs) store_surface(run, output, wood, write, ctx, leaves);
    });
}

void check_flags(const LeavesFlags& flags) {
    if (flags.outputs.empty() && flags.image.empty())
        throw UsageError("name the tree with leaves: coppice leaves SKELETON --species oak -o MESH");
    if (flags.species.empty())
        throw UsageError("name the species, as --species oak; coppice leaves lists all");
    for (const auto& output : flags.outputs) check_mesh_output(output);
    check_mesh_write_options(flags.write, flags.outputs);
    check_picture_output(flags.image);
    check_materials(flags.materials);
}

ExitCode add_leaves(Run& run, LeavesFlags flags, const GivenOptions& given) {
    if (flags.skeleton.empty()) return list_species(run);
    check_flags(flags);
    const LeafSpecies species = make_species(flags, given);
    MeshOptions& mesh = flags.mesh;
    std::string moved;
    flags.write.materials = find_materials(flags.materials);
    if (!flags.write.materials.empty()) {
        mesh.texture.coordinates = TextureCoordinates::bark;
        mesh.slots = make_slots(flags.materials, mesh.slots);
        moved = use_tile_of_image(run, given, flags.write.materials.front().color, mesh.texture);
    }
    const SkeletonFile file = load_skeleton(run, flags.skeleton, flags.read);
    const auto leaves = run.stage("leaves", [&](const Context& ctx) {
        return std::make_shared<const SurfaceLeaves>(
            make_surface_leaves(file.skeleton, species, flags.branchlets, flags.organs, flags.models, ctx));
    });
    const std::string summary = count_leaves(run, *leaves);
    if (leaves->tree.foliage.report.leaves == 0) {
        run.warn(fmt::format("the tree has no leaves in {}; change --season, --max-radius or --min-order",
                             name_of(species.rules.season)));
    }
    const MeshResult wood =
        run.stage("mesh", [&](const Context& ctx) { return mesh_skeleton(file.skeleton, mesh, ctx); });
    run.add_stages("mesh: ", wood.stages);
    if (!flags.outputs.empty()) write_tree(run, flags, wood, leaves);
    warn_of_lost_materials(run, flags.materials, flags.outputs);
    if (!flags.image.empty()) write_image(run, flags, wood, *leaves);
    const Verdict verdict = judge(run, wood, file.skeleton, mesh.control);
    run.finish(fmt::format("{}: {}; {}{}{}", flags.skeleton.string(), summary, count_surface(run, wood),
                           verdict.text, moved));
    return kDone;
}

}  // namespace

Command leaves_command() {
    const auto flags = std::make_shared<LeavesFlags>();
    OptionList options;
    options.file("skeleton", "SKELETON", flags->skeleton,
                 "Skeleton to which leaves are added; without it, all species are listed.");
    options.file("--species", "SPECIES", flags->species, "Species of the leaves, as oak or pine.");
    options.outputs("-o,--output", "MESH", flags->outputs,
                    "Tree with its leaves to write (.glb, .usda, .obj, .ply, .stl); may be repeated.");
    options.output("--image", "PNG", flags->image, "Image of the tree with its leaves to write (.png).");
    options.may_replace("--output", "species");  // not a file
    options.value(
        {{"models", "Number of different leaves, or branchlets.", Unit::none, 1, 1000}, &flags->models});
    options.value({{"instances", kInstancesHelp}, choice_of(flags->storage)});
    options.fields(flags->rules, "Places; the defaults are replaced by those of the species",
                   {.names = {{"internode", "--leaf-internode"},
                              {"angle", "--petiole-angle"},
                              {"size", "--leaf-size"},
                              {"density", "--leaf-density"}},
                    .common = MemberNames{"season", "max_radius", "shoot_length", "size", "seed"}});
    options.fields(flags->organs, "Flowers and fruit of the season", {.common = MemberNames{}});
    options.fields(flags->shape, "Shape of a leaf; the defaults are replaced by those of the species",
                   {.prefix = "leaf", .common = MemberNames{}});
    options.fields(flags->branchlets, "Branchlets: twigs with leaves that continue the branches",
                   {.prefix = "branchlet", .common = MemberNames{"length"}});
    options.fields(flags->mesh, "Surface", surface_flag_names(MemberNames{"levels"}));
    add_material_options(options, flags->materials);
    options.fields(flags->render, "Picture", {.common = MemberNames{}});
    add_mesh_write_options(options, flags->write);
    options.fields(flags->read, "Reading the skeleton", {.common = MemberNames{}});
    return {"leaves", "Make the surface of a skeleton with leaves on its shoots.", options,
            [flags](Run& run, const GivenOptions& given) { return add_leaves(run, *flags, given); },
            ManyFiles{leaves_command, "skeleton", ".glb", {FileKind::skeleton}}};
}

}  // namespace coppice::cli
