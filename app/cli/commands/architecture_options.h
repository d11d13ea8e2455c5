#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "options.h"

namespace coppice::cli {

/// Returns the numbers of a list such as 0.01,0.05; an empty list has none. Throws UsageError if the list is
/// invalid, or not ascending from above 0.
std::vector<double> rising_numbers(const std::filesystem::path& list, std::string_view option);

/// Options of the architecture of a skeleton, for tables and charts.
struct ArchitectureFlags {
    std::filesystem::path diameters = "0.01,0.02,0.05,0.1,0.2,0.5";  ///< a list, not a file
    float sholl_step = 0;

    /// Limits between diameter classes. Throws UsageError if the list is invalid, or not ascending from above
    /// 0.
    std::vector<double> limits() const;
};

void add_architecture_options(OptionList& options, ArchitectureFlags& flags);

}  // namespace coppice::cli
