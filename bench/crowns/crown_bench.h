#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "measure.h"

namespace coppice::bench {

/// One row of the table on crowns: the result, its time, and reference values.
struct CrownResult {
    std::string what;
    std::string goal;      ///< "<= 20 ms"; empty if there is no goal
    std::string baseline;  ///< cost of other programs; empty if unknown
    std::uint64_t size = 0;
    std::string unit;  ///< of `size`: points, nodes, values, segments
    std::uint64_t hash = 0;
    std::uint64_t peak_bytes = 0;   ///< peak memory above the input
    std::vector<Measure> measures;  ///< "all", and its stages

    double seconds() const;  ///< median of "all"
};

struct CrownOptions {
    /// maximum number of timed runs of a row; fewer if they would take longer than `seconds`
    int repeat = 9;
    double seconds = 20;  ///< [s] per row; at least three runs are made, but only one if it takes longer
    std::string only;     ///< only rows with this text in their name; empty = all
    bool huge = true;     ///< include the rows that take seconds: 1,000,000 attractors, maximum sampling
};

/// Measures implicit crowns, point sets, growth, and the way from the crown to the closed surface. Throws
/// Error if two runs of a row differ.
std::vector<CrownResult> bench_crowns(const CrownOptions& options, const Context& ctx);

/// Returns the rows as a Markdown table, then the stages.
std::string crown_markdown(const std::vector<CrownResult>& rows, unsigned threads,
                           const std::string& machine);
std::string crown_csv(const std::vector<CrownResult>& rows, unsigned threads);
std::string crown_json(const std::vector<CrownResult>& rows, unsigned threads, const std::string& machine);

}  // namespace coppice::bench
