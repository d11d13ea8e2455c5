#include <algorithm>
#include <span>

#include "coppice/scene/commands/tables_internal.h"
#include "coppice/texture/bark.h"

namespace coppice {
namespace {

using namespace table;

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
    // The defaults are those of the species.
    for (Argument& a : std::span(c.arguments).subspan(first)) {
        if (a.name != "seed") a.initial.clear();
    }
    c.run = [](const SceneCall& call) {
        constexpr double kBytesOfTexel = 18;
        const BarkOptions species = *find_bark(call.text("species"));
        BarkOptions options = call.options("bark", species);
        make_texels_square(options, species, call.has("height"), call.has("tile_height"));
        call.reserve(kBytesOfTexel * options.width * options.height);
        SurfaceMaterial made = make_bark_material(options, call.context());
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

std::vector<SceneCommand> material_commands() { return {material_command(), loadmaterial_command()}; }

}  // namespace coppice
