#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "command.h"
#include "coppice/base/quote.h"
#include "coppice/foliage/placement.h"
#include "coppice/growth/size.h"
#include "coppice/options/spelling.h"
#include "coppice/scene/drawn_material.h"
#include "coppice/scene/save.h"
#include "coppice/scene/species.h"
#include "files.h"
#include "leaf_pictures.h"
#include "pictures.h"
#include "results.h"
#include "scene_files.h"
#include "streams.h"
#include "surfaces.h"

namespace coppice::cli {
namespace {

struct TreeFlags {
    std::filesystem::path species, image;
    std::vector<std::filesystem::path> outputs;
    int age = 40;
    Season season = Season::summer;
    SceneFlags scene;
    InstanceStorage storage = InstanceStorage::instanced;
    RenderOptions render;
};

std::vector<std::string> list_names() {
    std::vector<std::string> names;
    for (const TreeSpecies& species : tree_species()) names.emplace_back(species.name);
    return names;
}

[[noreturn]] void refuse_species(const std::string& name) {
    const std::vector<std::string> names = list_names();
    throw UsageError(fmt::format("there is no species {}{}; the species are {}", quote(name),
                                 did_you_mean(name, names), fmt::join(names, ", ")));
}

/// Returns the scene of a species, or that of a file.
SceneFile read_species(Run& run, const std::filesystem::path& species) {
    if (species.extension() == ".coppice") return read_scenes(run, {&species, 1}).front();
    const auto found = find_tree_species(species.string());
    if (!found) refuse_species(species.string());
    return {std::string(found->name) + ".coppice", std::string(found->scene)};
}

/// Adds the value of an option to the settings of the scene, which must have such a variable.
void set_variable(SceneFlags& flags, const SceneFile& scene, const std::string& name,
                  const std::string& value) {
    const std::vector<std::string> known = find_variables(scene_lines(scene.text, scene.path.string()));
    if (std::ranges::find(known, name) == known.end())
        throw UsageError(fmt::format("--{0}: {1} has no variable {0}; add a line: let {0} = ...", name,
                                     scene.path.string()));
    flags.set.push_back(fmt::format("{}={}", name, value));
}

/// The last surface of a scene and the skeleton of its name.
struct MadeTree {
    ObjectPtr object;
    const Surface* surface = nullptr;
    const Skeleton* skeleton = nullptr;  ///< null if there is none
};

MadeTree find_tree(const Scene& scene, const SceneFile& file) {
    MadeTree out;
    const SceneState& state = scene.state();
    for (const auto& key : state.made) {
        const auto found = state.objects.find(key);
        if (key.first != ObjectKind::mesh || found == state.objects.end()) continue;
        out.object = found->second;
        out.surface = &std::get<Surface>(found->second->value);
        const auto skeleton = state.objects.find({ObjectKind::skeleton, key.second});
        out.skeleton =
            skeleton == state.objects.end() ? nullptr : &std::get<Skeleton>(skeleton->second->value);
    }
    if (!out.surface)
        throw InvalidInput(
            fmt::format("{}: the scene makes no surface; add a line: mesh TREE", file.path.string()));
    return out;
}

/// Adds the figures of the tree to the report; returns its summary.
std::string describe(Run& run, const MadeTree& tree) {
    std::string text = fmt::format("{} faces", grouped(face_count(*tree.surface)));
    run.counts()["faces"] = face_count(*tree.surface);
    if (tree.skeleton) {
        const TreeSize size = measure_size(*tree.skeleton);
        run.count_skeleton(*tree.skeleton);
        run.counts().update({{"height", size.height}, {"dbh", size.dbh}, {"width", size.width}});
        text =
            fmt::format("{:.3g} m high, {:.3g} m wide, {:.2g} m thick; ", size.height, size.width, size.dbh) +
            text;
    }
    if (tree.surface->verdict) {
        run.counts()["crossings"] = tree.surface->verdict->crossings;
        text += report_verdict(run, *tree.surface->verdict).text;
    }
    if (tree.surface->leaves) text += "; " + count_leaves(run, *tree.surface->leaves);
    return text;
}

void write_image(Run& run, const TreeFlags& flags, const Surface& surface) {
    PolygonMesh mesh = make_polygons(surface);
    if (!surface.texture.empty()) mesh.texture = surface.texture;
    if (!surface.texture_blends.empty()) mesh.texture_blends = surface.texture_blends;
    const FaceMaterials bark = run.stage("read images", [&](const Context& ctx) {
        return load_face_materials(surface.materials, surface.slots, ctx);
    });
    write_leafed_picture(run, flags.image, mesh, bark, surface.leaves.get(), flags.render);
}

ExitCode make_tree(Run& run, TreeFlags flags, const GivenOptions& given) {
    if (flags.species.empty())
        throw UsageError("name the species, as in: coppice tree oak -o oak.glb; coppice species lists all");
    const SceneFile file = read_species(run, flags.species);
    if (flags.outputs.empty() && flags.image.empty())
        throw UsageError("name the tree: coppice tree SPECIES -o MESH, or --image PNG");
    if (is_given(given, "--age")) set_variable(flags.scene, file, "age", std::to_string(flags.age));
    if (is_given(given, "--season"))
        set_variable(flags.scene, file, "season", std::string(name_of(flags.season)));
    const auto commands = commands_of_scenes({&file, 1});
    for (const auto& output : flags.outputs) {
        check_output_folder(output);
        if (commands) check_scene_output(*commands, output);
    }
    check_picture_output(flags.image);
    SceneSettings settings = scene_settings(run, flags.scene, {&file, 1});
    settings.outputs = false;
    settings.judge = true;
    Scene scene(std::move(settings));
    run_scene(run, scene, file);
    const MadeTree tree = find_tree(scene, file);
    run.stage("write", [&](const Context& ctx) {
        for (const auto& output : flags.outputs)
            store_object(run, output, *object_for_file(scene.state(), {}, output), flags.storage, ctx);
    });
    if (!flags.image.empty()) write_image(run, flags, *tree.surface);
    run.finish(fmt::format("{}: {}", flags.species.string(), describe(run, tree)));
    return kDone;
}

ExitCode list_species(Run& run, const std::filesystem::path& name) {
    if (!name.empty()) {
        const auto found = find_tree_species(name.string());
        if (!found) refuse_species(name.string());
        run.print(std::string(found->scene));
        run.finish(fmt::format("{} printed", name.string()));
        return kDone;
    }
    std::string text;
    Json figures = Json::array();
    for (const TreeSpecies& species : tree_species()) {
        text += fmt::format("{:<16} {}\n", species.name, species.title);
        figures.push_back({{"species", species.name}, {"description", species.title}});
    }
    run.print(text);
    run.counts()["species"] = figures;
    run.finish(fmt::format("{} species", tree_species().size()));
    return kDone;
}

}  // namespace

Command tree_command() {
    const auto flags = std::make_shared<TreeFlags>();
    OptionList options;
    options.file("species", "SPECIES", flags->species,
                 "Species, as oak, or a scene that makes a tree (.coppice).");
    options.outputs(
        "-o,--output", "FILE", flags->outputs,
        "Tree with its leaves to write (.glb, .usda, .obj, .ply, .stl), or its skeleton (.swc, .json, "
        ".csv); may be repeated.");
    options.output("--image", "PNG", flags->image, "Image of the tree with its leaves to write (.png).");
    options.may_replace("--output", "species");
    options.value({common_field("age", "Age of the tree in years.", Unit::none, 1, 1000), &flags->age});
    options.value(
        {common_field("season", "Season, which sets sizes, colours and the share of fallen leaves."),
         choice_of(flags->season)});
    add_scene_options(options, flags->scene);
    options.value({{"instances", kInstancesHelp}, choice_of(flags->storage)});
    options.fields(flags->render, "Picture", {.common = MemberNames{}});
    return {"tree", "Make a finished tree of a species: its surface with bark and leaves.", options,
            [flags](Run& run, const GivenOptions& given) { return make_tree(run, *flags, given); }};
}

Command species_command() {
    const auto name = std::make_shared<std::filesystem::path>();
    OptionList options;
    options.file("species", "SPECIES", *name,
                 "Species of which the scene is printed; without it, all are listed.");
    return {"species", "List the species of coppice tree, or print the scene of one to copy and change it.",
            options, [name](Run& run, const GivenOptions&) { return list_species(run, *name); }};
}

}  // namespace coppice::cli
