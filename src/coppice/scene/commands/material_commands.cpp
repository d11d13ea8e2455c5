#include <algorithm>
#include <span>

#include "coppice/scene/commands/tables_internal.h"
#include "coppice/texture/bark.h"
#include "coppice/texture/cut.h"

namespace coppice {
namespace {

using namespace table;

constexpr double kBytesOfMadeTexel = 18;

SceneCommand in_group(std::string name, std::string help, std::string example) {
    SceneCommand c = new_command(std::move(name), "Materials", std::move(help), std::move(example));
    c.makes = ObjectKind::material;
    return c;
}

Argument species_argument() {
    Argument a{.name = "species", .help = "Species, or a kind of bark.", .type = ArgumentType::choice};
    a.positional = a.required = true;
    for (const BarkSpecies& species : bark_species()) a.choices.emplace_back(species.name);
    for (const std::string_view kind : EnumNames<BarkKind>::names) {
        // Kinds may have the name of a species.
        if (std::ranges::find(a.choices, kind) == a.choices.end()) a.choices.emplace_back(kind);
    }
    return a;
}

/// Clears the defaults, which are those of the species.
void clear_initials(std::span<Argument> arguments) {
    for (Argument& a : arguments) {
        if (a.name != "seed") a.initial.clear();
    }
}

SceneOutcome makes_material(const SceneCall& call, SurfaceMaterial material) {
    const std::uint64_t bytes = compute_memory(material);
    return makes(call.text("name"), std::move(material), bytes);
}

SceneCommand material_command() {
    SceneCommand c =
        in_group("material", "Make the images of a bark by program.", "material bark oak width=64");
    c.arguments = {new_name("name", "Name of the new material."), species_argument()};
    const std::size_t first = c.arguments.size();
    add_options(c.arguments, BarkOptions{}, "bark");
    clear_initials(std::span(c.arguments).subspan(first));
    c.run = [](const SceneCall& call) {
        const BarkOptions species = *find_bark(call.text("species"));
        BarkOptions options = call.options("bark", species);
        make_texels_square(options, species, call.has("height"), call.has("tile_height"));
        call.reserve(kBytesOfMadeTexel * options.width * options.height);
        SurfaceMaterial made = make_bark_material(options, call.context());
        made.files.name = make_material_name(call.text("name"));
        return makes_material(call, std::move(made));
    };
    return c;
}

SceneCommand cutmaterial_command() {
    SceneCommand c = in_group("cutmaterial", "Make a picture of cut wood by program, for flat ends.",
                              "cutmaterial wood oak size=64");
    Argument species{.name = "species", .help = "Species.", .type = ArgumentType::choice};
    species.positional = species.required = true;
    for (const CutSpecies& s : cut_species()) species.choices.emplace_back(s.name);
    c.arguments = {new_name("name", "Name of the new material."), std::move(species)};
    const std::size_t first = c.arguments.size();
    add_options(c.arguments, CutOptions{}, "cut");
    clear_initials(std::span(c.arguments).subspan(first));
    c.run = [](const SceneCall& call) {
        const CutOptions options = call.options("cut", *find_cut(call.text("species")));
        call.reserve(kBytesOfMadeTexel * options.size * options.size);
        SurfaceMaterial made = make_cut_material(options, call.context());
        made.files.name = make_material_name(call.text("name"));
        return makes_material(call, std::move(made));
    };
    return c;
}

SceneCommand loadmaterial_command() {
    SceneCommand c =
        in_group("loadmaterial", "Use the images of a material in files, as made by coppice texture.",
                 "loadmaterial wood oak_bark_color.png");
    c.arguments = {new_name("name", "Name of the new material."),
                   file("file", ArgumentType::input_file,
                        "Image of the colour, PREFIX_color.png; the other images of PREFIX are used too.")};
    c.run = [](const SceneCall& call) {
        return makes_material(call, load_surface_material(call.input("file"), call.sandbox()));
    };
    return c;
}

}  // namespace

std::vector<SceneCommand> material_commands() {
    return {material_command(), cutmaterial_command(), loadmaterial_command()};
}

}  // namespace coppice
