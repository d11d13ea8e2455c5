#include <fmt/format.h>

#include <memory>

#include "command.h"
#include "coppice/base/quote.h"
#include "coppice/foliage/leaf_species.h"
#include "coppice/io_mesh/writer.h"
#include "coppice/options/spelling.h"
#include "files.h"
#include "options.h"
#include "streams.h"

namespace coppice::cli {
namespace {

struct LeavesFlags {
    std::filesystem::path skeleton, species, output;
    int models = 3;
    LeafShape shape;
    LeafRules rules;
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
    print(text);
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

/// Returns one mesh of all leaves with its texture coordinates.
std::pair<TriMesh, std::vector<TexturePoint>> merge(const std::vector<LeafModel>& models,
                                                    const Instances& leaves) {
    std::pair<TriMesh, std::vector<TexturePoint>> out;
    auto& [mesh, texture] = out;
    mesh.origin = leaves.origin;
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        const Prototype& leaf = models[leaves.prototypes[i]].prototype;
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const Vec3 p : leaf.mesh.positions)
            mesh.positions.push_back(leaves.positions[i] + rotate(leaves.rotations[i], leaves.scales[i] * p));
        for (const Triangle& t : leaf.mesh.triangles)
            mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
        texture.insert(texture.end(), leaf.texture.begin(), leaf.texture.end());
    }
    return out;
}

ExitCode make_leaves_of_tree(Run& run, const LeavesFlags& flags, const GivenOptions& given) {
    if (flags.skeleton.empty()) return list_species(run);
    if (flags.output.empty())
        throw UsageError("name the leaves: coppice leaves SKELETON --species oak -o MESH");
    if (flags.species.empty())
        throw UsageError("name the species, as --species oak; coppice leaves lists all");
    check_mesh_output(flags.output);
    const LeafSpecies species = make_species(flags, given);
    const SkeletonFile file = load_skeleton(run, flags.skeleton, flags.read);
    const std::vector<LeafModel> models =
        run.stage("models", [&](const Context&) { return make_leaves(species.shape, flags.models); });
    const Foliage foliage = run.stage("leaves", [&](const Context& ctx) {
        return place_leaves(file.skeleton, models, species.rules, ctx);
    });
    visit_figures(foliage.report, [&](const char* name, auto value) { run.counts()[name] = value; });
    if (foliage.instances.empty())
        throw InvalidInput(fmt::format("{} has no leaves in {}; change season, max_radius or min_order",
                                       flags.skeleton.string(), name_of(species.rules.season)));
    run.stage("write", [&](const Context& ctx) {
        const auto [mesh, texture] = merge(models, foliage.instances);
        write_mesh(flags.output, mesh, {.texture = texture}, ctx);
    });
    run.finish(fmt::format("{}: {} leaves of {:.3g} m2, leaf area index {:.3g}, {} removed in wood",
                           flags.output.string(), grouped(foliage.report.leaves), foliage.report.leaf_area,
                           foliage.report.leaf_area_index, grouped(foliage.report.inside_wood)));
    return kDone;
}

}  // namespace

Command leaves_command() {
    const auto flags = std::make_shared<LeavesFlags>();
    OptionList options;
    options.file("skeleton", "SKELETON", flags->skeleton,
                 "Skeleton to which leaves are added; without it, all species are listed.");
    options.file("--species", "SPECIES", flags->species, "Species of the leaves, as oak or pine.");
    options.output("-o,--output", "MESH", flags->output,
                   "Mesh of all leaves to write (.obj, .ply, .glb, .usda, .stl).");
    options.may_replace("--output", "species");  // not a file
    options.value({{"models", "Number of different leaves.", Unit::none, 1, 1000}, &flags->models});
    options.fields(flags->rules, "Places; the defaults are replaced by those of the species",
                   {.names = {{"internode", "--leaf-internode"},
                              {"angle", "--petiole-angle"},
                              {"size", "--leaf-size"},
                              {"density", "--leaf-density"}},
                    .common = MemberNames{"season", "max_radius", "shoot_length", "internode", "density",
                                          "size", "seed"}});
    options.fields(flags->shape, "Shape of a leaf; the defaults are replaced by those of the species",
                   {.prefix = "leaf", .common = MemberNames{"length", "width", "rows"}});
    options.fields(flags->read, "Reading the skeleton", {.common = MemberNames{}});
    return {"leaves", "Add leaves to the shoots of a skeleton.", options,
            [flags](Run& run, const GivenOptions& given) { return make_leaves_of_tree(run, *flags, given); }};
}

}  // namespace coppice::cli
