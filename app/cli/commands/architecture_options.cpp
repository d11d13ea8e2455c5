#include "architecture_options.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <sstream>
#include <string>

#include "coppice/base/quote.h"

namespace coppice::cli {

std::vector<double> rising_numbers(const std::filesystem::path& list, std::string_view option) {
    std::vector<double> out;
    std::istringstream words(list.string());
    for (std::string word; std::getline(words, word, ',');) {
        double number = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
        const bool rises = number > (out.empty() ? 0 : out.back()) && std::isfinite(number);
        if (error != std::errc{} || end != word.data() + word.size() || !rises)
            throw UsageError(fmt::format(
                "{} takes ascending numbers above 0 separated by commas, as in 0.01,0.05,0.1, and not {}",
                option, quote(list.string())));
        out.push_back(number);
    }
    return out;
}

std::vector<double> ArchitectureFlags::limits() const { return rising_numbers(diameters, "--diameters"); }

void add_architecture_options(OptionList& options, ArchitectureFlags& flags) {
    options.file("--diameters", "LIST", flags.diameters,
                 "Limits of the diameter classes, in the units of the files, as in 0.01,0.05,0.1.");
    options.value({common_field("sholl_step",
                                "Distance between the spheres of the Sholl analysis; 0 uses 1 % of the "
                                "greatest distance from the root.",
                                Unit::metre, 0, 1e9),
                   &flags.sholl_step});
}

}  // namespace coppice::cli
