#include "timber.h"

#include <fmt/format.h>

#include "commands/architecture_options.h"
#include "coppice/options/json.h"

namespace coppice::cli {
namespace {

void add_stem(Json& out, double top, const TimberVolume& of, const FigureName& name) {
    out.update({{name(fmt::format("stem_length_to_{:g}", top), 1), of.stem_length},
                {name(fmt::format("stem_volume_to_{:g}", top), 3), of.stem_volume}});
}

/// Adds the figures of a stem and the volume of its tree.
void add_timber(Json& out, double top, const TimberVolume& of, const FigureName& name) {
    add_stem(out, top, of, name);
    out[name(fmt::format("timber_from_{:g}", top), 3)] = of.volume;
}

}  // namespace

std::vector<double> TimberFlags::tops() const {
    if (top_diameters.empty() && stump_height > 0)
        throw UsageError("--stump-height requires --top-diameters, as in --top-diameters 0.07,0.2");
    return rising_numbers(top_diameters, "--top-diameters");
}

void add_timber_options(OptionList& options, TimberFlags& flags) {
    options.file("--top-diameters", "LIST", flags.top_diameters,
                 "Minimum diameters of timber, in the units of the files, as in 0.07,0.2.");
    options.value(
        {Field{"stump_height", "Height above the root at which the timber begins.", Unit::metre, 0, 1e3},
         &flags.stump_height});
    options.value({Field{"wood_density", "Density of the wood in kg/m3, which converts volumes to biomass.",
                         Unit::none, 0, 2000},
                   &flags.wood_density});
}

Timber::Timber(const Skeleton& skeleton, const BranchTable& table, const TimberFlags& flags)
    : tops_(flags.tops()) {
    for (const double top : tops_)
        volumes_.push_back(timber_volumes(skeleton, table, top, shortest(flags.stump_height)));
}

void Timber::add_tree(Json& out, std::size_t tree, const FigureName& name) const {
    for (std::size_t k = 0; k < tops_.size(); ++k) add_timber(out, tops_[k], volumes_[k][tree], name);
}

void Timber::add_all(Json& out, const FigureName& name) const {
    for (std::size_t k = 0; k < tops_.size(); ++k) {
        TimberVolume sum;
        for (const TimberVolume& tree : volumes_[k]) {
            sum.stem_length += tree.stem_length;
            sum.stem_volume += tree.stem_volume;
            sum.volume += tree.volume;
        }
        add_timber(out, tops_[k], sum, name);
    }
}

void add_stem_timber(Json& out, const StemForm& form, const TimberFlags& flags, const FigureName& name) {
    const auto stem = stem_skeleton(form);
    if (!stem) return;
    const BranchTable table = list_branches(*stem);
    for (const double top : flags.tops())
        add_stem(out, top, timber_volumes(*stem, table, top, shortest(flags.stump_height)).front(), name);
}

}  // namespace coppice::cli
