#pragma once

#include <filesystem>
#include <vector>

#include "coppice/extract/stem/stem_form.h"
#include "coppice/skeleton/branches.h"
#include "files.h"
#include "options.h"

namespace coppice::cli {

/// Options for the timber and biomass of trees.
struct TimberFlags {
    std::filesystem::path top_diameters;  ///< a list, not a file
    float stump_height = 0;               ///< [m]
    float wood_density = 0;               ///< [kg/m^3] 0: not given

    /// Returns whether any option is set.
    bool any() const { return !top_diameters.empty() || stump_height > 0 || wood_density > 0; }
    /// Throws UsageError if the list is invalid, not ascending, or missing although a stump height is given.
    std::vector<double> tops() const;
};

void add_timber_options(OptionList& options, TimberFlags& flags);

/// The timber of the trees of one skeleton.
class Timber {
  public:
    Timber(const Skeleton& skeleton, const BranchTable& table, const TimberFlags& flags);

    /// Adds the figures of one tree, or the sums of all.
    void add_tree(Json& out, std::size_t tree, const FigureName& name) const;
    void add_all(Json& out, const FigureName& name) const;

  private:
    std::vector<double> tops_;
    std::vector<std::vector<TimberVolume>> volumes_;  // [top][tree]
};

/// Adds the figures of a stem known only by its sections: those of Timber without the volume of branches.
void add_stem_timber(Json& out, const StemForm& form, const TimberFlags& flags, const FigureName& name);

}  // namespace coppice::cli
