#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "options.h"

namespace coppice::cli {

/// The numbers of a list such as 0.01,0.05, none of an empty one. Throws UsageError where it is none, or does
/// not rise from above 0.
std::vector<double> rising_numbers(const std::filesystem::path& list, std::string_view option);

/// How the architecture of a skeleton is counted, for tables and charts alike.
struct ArchitectureFlags {
    std::filesystem::path diameters = "0.01,0.02,0.05,0.1,0.2,0.5";  ///< a list, no file
    float sholl_step = 0;

    /// Between classes of diameter. Throws UsageError where the list is none, or does not rise from above 0.
    std::vector<double> limits() const;
};

void add_architecture_options(OptionList& options, ArchitectureFlags& flags);

}  // namespace coppice::cli
