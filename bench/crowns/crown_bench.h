#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "measure.h"

namespace coppice::bench {

/// One row of the table on crowns: what was made, how long it took, and what it is held against.
struct CrownResult {
    std::string what;
    std::string goal;      ///< "<= 20 ms"; empty where none is set
    std::string baseline;  ///< what others need for it; empty where nothing is known
    std::uint64_t size = 0;
    std::string unit;  ///< of `size`: points, nodes, values, segments
    std::uint64_t hash = 0;
    std::uint64_t peak_bytes = 0;   ///< memory in use at the worst moment, above the input
    std::vector<Measure> measures;  ///< "all", and its stages

    double seconds() const;  ///< median of "all"
};

struct CrownOptions {
    int repeat = 9;       ///< timed runs of a row; fewer where they would take longer than `seconds`
    double seconds = 20;  ///< [s] per row; at least three are made, but where one takes longer, only that
    std::string only;     ///< rows that have this in their name; empty = all
    bool huge = true;     ///< also the rows that take seconds: 1,000,000 attractors, as many as fit
};

/// Implicit crowns, point sets, growth, and from the crown to the closed surface. Throws Error when two runs
/// of a row differ.
std::vector<CrownResult> bench_crowns(const CrownOptions& options, const Context& ctx);

/// The rows as a Markdown table, then the stages.
std::string crown_markdown(const std::vector<CrownResult>& rows, unsigned threads,
                           const std::string& machine);
std::string crown_csv(const std::vector<CrownResult>& rows, unsigned threads);
std::string crown_json(const std::vector<CrownResult>& rows, unsigned threads, const std::string& machine);

}  // namespace coppice::bench
