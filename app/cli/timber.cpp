#include "timber.h"

#include <fmt/format.h>

#include "commands/architecture_options.h"
#include "coppice/pipeline/json.h"

namespace coppice::cli {

std::vector<double> TimberFlags::tops() const {
    if (top_diameters.empty() && stump_height > 0)
        throw UsageError("--stump-height is for timber; name its --top-diameters, as in 0.07,0.2");
    return rising_numbers(top_diameters, "--top-diameters");
}

void add_timber_options(OptionList& options, TimberFlags& flags) {
    options.file("--top-diameters", "LIST", flags.top_diameters,
                 "Diameters down to which wood is timber, in the units of the files, as in 0.07,0.2");
    options.value({Field{"stump_height", "Height above the root below which the stem is no timber",
                         Unit::metre, 0, 1e3},
                   &flags.stump_height});
    options.value({Field{"wood_density",
                         "Density of the wood in kg/m3, by which volumes are multiplied for the biomass",
                         Unit::none, 0, 2000},
                   &flags.wood_density});
}

Timber::Timber(const Skeleton& skeleton, const BranchTable& table, const TimberFlags& flags)
    : tops_(flags.tops()) {
    for (const double top : tops_)
        volumes_.push_back(timber_volumes(skeleton, table, top, shortest(flags.stump_height)));
}

void Timber::add_tree(Figures& out, std::size_t tree, const Name& name) const {
    std::vector<TimberVolume> of_tops;
    for (const auto& trees : volumes_) of_tops.push_back(trees[tree]);
    add(out, of_tops, name);
}

void Timber::add_all(Figures& out, const Name& name) const {
    std::vector<TimberVolume> of_tops;
    for (const auto& trees : volumes_) {
        TimberVolume& sum = of_tops.emplace_back();
        for (const TimberVolume& tree : trees) {
            sum.stem_length += tree.stem_length;
            sum.stem_volume += tree.stem_volume;
            sum.volume += tree.volume;
        }
    }
    add(out, of_tops, name);
}

void Timber::add(Figures& out, std::span<const TimberVolume> of_tops, const Name& name) const {
    for (std::size_t k = 0; k < tops_.size(); ++k) {
        out[name(fmt::format("stem_length_to_{:g}", tops_[k]), 1)] = of_tops[k].stem_length;
        out[name(fmt::format("stem_volume_to_{:g}", tops_[k]), 3)] = of_tops[k].stem_volume;
        out[name(fmt::format("timber_from_{:g}", tops_[k]), 3)] = of_tops[k].volume;
    }
}

}  // namespace coppice::cli
