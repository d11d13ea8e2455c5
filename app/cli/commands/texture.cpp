#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "bark_picture.h"
#include "command.h"
#include "coppice/base/quote.h"
#include "coppice/options/quantity.h"
#include "coppice/options/spelling.h"
#include "coppice/scene/bark_images.h"
#include "coppice/system/file.h"
#include "coppice/texture/bark.h"
#include "coppice/texture/cut.h"
#include "files.h"
#include "options.h"
#include "pictures.h"
#include "results.h"

namespace coppice::cli {
namespace {

constexpr const char* kBarkGroup = "Bark; the defaults are those of oak, every species has its own";
constexpr const char* kCutGroup = "Cut wood; the defaults are those of oak, every species has its own";

struct TextureFlags {
    std::filesystem::path kind, species, output, picture;
    int picture_width = 1200;
    BarkOptions bark;
    CutOptions cut;
};

/// Prints the species with their sizes.
ExitCode list_species(Run& run) {
    std::string text = fmt::format("{:<10} {:<12} {:>7} {:>8} {:>7} {:>7} {:>8}  {}\n", "species", "kind",
                                   "tile m", "stem m", "mm", "stretch", "deep mm", "description");
    Json figures = Json::array();
    for (const BarkSpecies& species : bark_species()) {
        const BarkOptions& o = species.options;
        text += fmt::format("{:<10} {:<12} {:>7.3g} {:>8.3g} {:>7.3g} {:>7.3g} {:>8.3g}  {}\n", species.name,
                            name_of(o.kind), o.tile_width, o.mature_diameter, 1e3 * double{o.spacing},
                            o.stretch, 1e3 * double{o.depth}, species.title);
        figures.push_back(
            {{"species", species.name}, {"kind", name_of(o.kind)}, {"description", species.title}});
    }
    text +=
        fmt::format("\n{:<10} {:<12} {:>7} {:>8}  {}\n", "species", "", "disc m", "rings mm", "description");
    for (const CutSpecies& species : cut_species()) {
        const CutOptions& o = species.options;
        text += fmt::format("{:<10} {:<12} {:>7.3g} {:>8.3g}  {}\n", species.name, "cut", o.diameter,
                            1e3 * double{o.ring_width}, species.title);
        figures.push_back({{"species", species.name}, {"kind", "cut"}, {"description", species.title}});
    }
    run.print(text);
    run.counts()["species"] = figures;
    run.finish(
        fmt::format("{} species of bark, {} of cut wood", bark_species().size(), cut_species().size()));
    return kDone;
}

BarkOptions options_of_species(const std::string& name) {
    if (const auto found = find_bark(name)) return *found;
    std::vector<std::string> names;
    for (const BarkSpecies& species : bark_species()) names.emplace_back(species.name);
    for (const std::string_view kind : EnumNames<BarkKind>::names) names.emplace_back(kind);
    throw UsageError(fmt::format("there is no bark {}{}; coppice texture lists the species", quote(name),
                                 did_you_mean(name, names)));
}

/// Returns the options of the species with those of the command line.
BarkOptions make_options(const TextureFlags& flags, const GivenOptions& given) {
    const BarkOptions species = options_of_species(flags.species.string());
    BarkOptions out = species;
    BarkOptions typed = flags.bark;
    copy_given(option_fields(typed), option_fields(out), given);
    const auto is_typed = [&](std::string_view field) {
        return std::ranges::any_of(given, [&](const Option* option) { return option->field == field; });
    };
    make_texels_square(out, species, is_typed("height"), is_typed("tile_height"));
    return out;
}

/// Returns the options of cut wood with those of the command line.
CutOptions make_cut_options(const TextureFlags& flags, const GivenOptions& given) {
    const std::string name = flags.species.string();
    auto out = find_cut(name);
    if (!out) {
        std::vector<std::string> names;
        for (const CutSpecies& species : cut_species()) names.emplace_back(species.name);
        throw UsageError(fmt::format("there is no cut wood of {}{}; coppice texture lists the species",
                                     quote(name), did_you_mean(name, names)));
    }
    CutOptions typed = flags.cut;
    copy_given(option_fields(typed), option_fields(*out), given);
    return *out;
}

/// Returns the beginning of the names of all maps; within a folder it is the name of the species.
std::string find_prefix(const TextureFlags& flags) {
    std::error_code error;
    const bool is_folder = !flags.output.has_filename() || std::filesystem::is_directory(flags.output, error);
    return (is_folder ? flags.output / flags.species.filename() : flags.output).string();
}

void write_maps(Run& run, const BarkMaps& maps, const std::string& prefix) {
    // All maps are encoded before the first file is written.
    const std::vector<BarkImage> images =
        run.stage("encode", [&](const Context& ctx) { return encode_bark(maps, ctx); });
    Json names = Json::array();
    run.stage("write", [&](const Context&) {
        for (const BarkImage& image : images) {
            names.push_back(make_bark_file_name(prefix, image.map));
            write_file(make_bark_file_name(prefix, image.map), image.bytes);
        }
    });
    run.counts()["files"] = names;
}

void check_flags(const TextureFlags& flags, const GivenOptions& given) {
    const std::string subject = flags.kind.string();
    if (flags.species.empty()) {
        throw UsageError(fmt::format(
            "name the species, as coppice texture {0} oak -o oak_{0}; coppice texture lists all", subject));
    }
    if (flags.output.empty() && flags.picture.empty()) {
        throw UsageError(fmt::format("name the files: coppice texture {1} {0} -o {0}_{1}, or --picture PNG",
                                     flags.species.string(), subject));
    }
    if (const Option* other = first_of_groups(given, {subject == "cut" ? kBarkGroup : kCutGroup}))
        throw UsageError(fmt::format("{} does not apply to coppice texture {}", other->name, subject));
}

ExitCode make_textures(Run& run, const TextureFlags& flags, const GivenOptions& given) {
    const bool is_cut = flags.kind == "cut";
    check_flags(flags, given);
    const BarkOptions bark = is_cut ? BarkOptions{} : make_options(flags, given);
    const CutOptions cut = is_cut ? make_cut_options(flags, given) : CutOptions{};
    check_picture_output(flags.picture);
    const std::string prefix = find_prefix(flags);
    if (!flags.output.empty()) check_output_folder(prefix);
    const BarkMaps maps = run.stage(flags.kind.string(), [&](const Context& ctx) {
        return is_cut ? make_cut(cut, ctx) : make_bark(bark, ctx);
    });
    if (!flags.output.empty()) write_maps(run, maps, prefix);
    if (!flags.picture.empty()) {
        const Image picture = run.stage("draw", [&](const Context& ctx) {
            return is_cut ? draw_cut(maps, flags.picture_width, ctx)
                          : draw_bark(maps, bark.diameter, flags.picture_width, ctx);
        });
        run.stage("write picture", [&](const Context&) { store_picture(run, flags.picture, picture); });
    }
    run.counts().update({{"width", maps.width},
                         {"height", maps.height},
                         {"tile_width_m", maps.tile_width},
                         {"tile_height_m", maps.tile_height},
                         {"low_m", maps.low},
                         {"high_m", maps.high},
                         {"height_scale_m", maps.high - maps.low}});
    run.finish(fmt::format("{}: {} x {} texels, {:.3g} x {:.3g} m, heights over {:.3g} mm",
                           flags.output.empty() ? flags.picture.string() : prefix, maps.width, maps.height,
                           maps.tile_width, maps.tile_height, 1e3 * double{maps.high - maps.low}));
    return kDone;
}

ExitCode make_texture(Run& run, const TextureFlags& flags, const GivenOptions& given) {
    if (flags.kind.empty()) return list_species(run);
    const std::vector<std::string> kinds{"bark", "cut"};
    if (std::ranges::find(kinds, flags.kind.string()) == kinds.end()) {
        throw UsageError(fmt::format(
            "there are no textures of {}{}; use coppice texture bark SPECIES or coppice texture cut SPECIES",
            quote(flags.kind.string()), did_you_mean(flags.kind.string(), kinds)));
    }
    return make_textures(run, flags, given);
}

}  // namespace

Command texture_command() {
    const auto flags = std::make_shared<TextureFlags>();
    OptionList options;
    options.file("subject", "SUBJECT", flags->kind,
                 "Kind of the textures: bark, or cut for flat ends; without it, all species are listed.");
    options.file("species", "SPECIES", flags->species, "Species, or a kind of bark, as oak or furrowed.");
    options.output(
        "-o,--output", "PREFIX", flags->output,
        "Beginning of the names of the maps to write: PREFIX_color.png, PREFIX_normal.png and so on.");
    // These are not files.
    options.may_replace("--output", "subject");
    options.may_replace("--output", "species");
    options.output("--picture", "PNG", flags->picture,
                   "Image of a ball and a stem with the bark, or of a disc, to write (.png).");
    options.value(
        {{"picture_width", "Width of that image in pixels.", Unit::none, 32, 8192}, &flags->picture_width});
    options.fields(flags->bark, kBarkGroup);
    options.fields(flags->cut, kCutGroup, {.prefix = "cut", .common = MemberNames{}});
    return {
        "texture",
        "Make textures of bark, which tile, or of cut wood: colour, normals, roughness, heights, occlusion.",
        options, [flags](Run& run, const GivenOptions& given) { return make_texture(run, *flags, given); }};
}

}  // namespace coppice::cli
