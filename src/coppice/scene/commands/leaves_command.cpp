#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "coppice/foliage/leaf_species.h"
#include "coppice/scene/commands/tables_internal.h"
#include "coppice/scene/surface_leaves.h"

namespace coppice {
namespace {

using namespace table;

Argument species_argument() {
    Argument a{.name = "species", .help = "Species of the leaves.", .type = ArgumentType::choice};
    a.positional = a.required = true;
    for (const LeafSpecies& species : leaf_species()) a.choices.emplace_back(species.name);
    return a;
}

Argument models_argument() {
    Argument a = number("models", "3", 1, 1000, Unit::none, "Number of different leaves, or branchlets.");
    a.type = ArgumentType::whole;
    return a;
}

/// Returns the names of all members of an option struct with a prefix.
template <OptionStruct Options>
std::map<std::string, std::string> add_prefix(Options options, const std::string& path,
                                              const std::string& prefix) {
    std::map<std::string, std::string> names;
    visit_members(option_fields(options), path, [&](const std::string& member, const OptionField&) {
        names[member] = prefix + member.substr(path.size() + 1);
    });
    return names;
}

/// Adds the options of a species, the defaults of which are its own.
template <OptionStruct Options>
void add_species_options(std::vector<Argument>& arguments, Options options, const std::string& path,
                         const std::map<std::string, std::string>& names) {
    const std::size_t first = arguments.size();
    add_options(arguments, options, path, {}, names);
    for (Argument& a : std::span(arguments).subspan(first)) {
        if (a.name != "seed") a.initial.clear();
    }
}

SceneOutcome add_leaves(const SceneCall& call) {
    LeafSpecies species = *find_leaf_species(call.text("species"));
    species.rules = call.options("rules", species.rules);
    species.shape = call.options("shape", species.shape);
    const std::string& name = call.text("mesh");
    Surface surface = call.surface(name);
    const auto leaves = std::make_shared<const SurfaceLeaves>(make_surface_leaves(
        call.skeleton(call.text("tree")), species, call.options<BranchletOptions>("branchlet"),
        call.options<OrganOptions>("organ"), static_cast<int>(call.number("models")), call.context()));
    call.reserve(static_cast<double>(compute_memory(*leaves)));
    surface.leaves = leaves;
    const std::uint64_t bytes = compute_memory(surface);
    return makes(name, std::move(surface), bytes);
}

}  // namespace

SceneCommand leaves_command() {
    SceneCommand c = new_command("leaves", "Trees", "Add leaves, flowers and fruit to the surface of a tree.",
                                 "leaves tree oak");
    c.makes = ObjectKind::mesh;
    Argument tree =
        object_option("tree", ObjectKind::skeleton, "Skeleton of the surface, on which the leaves grow.");
    tree.initial = "@mesh";
    c.arguments = {object("mesh", ObjectKind::mesh, "Surface to change."), species_argument(),
                   std::move(tree), models_argument()};
    add_species_options(c.arguments, LeafRules{}, "rules",
                        {{"rules.internode", "leaf_internode"},
                         {"rules.angle", "petiole_angle"},
                         {"rules.size", "leaf_size"},
                         {"rules.density", "leaf_density"}});
    add_species_options(c.arguments, LeafShape{}, "shape", add_prefix(LeafShape{}, "shape", "leaf_"));
    add_options(c.arguments, OrganOptions{}, "organ", {}, {});
    add_options(c.arguments, BranchletOptions{}, "branchlet", {},
                add_prefix(BranchletOptions{}, "branchlet", "branchlet_"));
    c.run = add_leaves;
    return c;
}

}  // namespace coppice
