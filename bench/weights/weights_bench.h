#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/field/field_options.h"
#include "coppice/mesh/statistics.h"
#include "measure.h"

namespace coppice::bench {

/// One surface with weights computed by one method.
struct WeightsResult {
    std::string scene, kernel;
    std::string weights;  ///< "local, blend 4" (the default), "local, plain sum" [Zhu2015], "global", ...
    std::uint64_t segments = 0;
    std::uint64_t constraints = 0, zero = 0;    ///< of global weights
    double residual_rms = 0, residual_max = 0;  ///< of the plain sum at the constraints, [level]
    Statistics regular;                         ///< radius deviation away from nodes, see RadiusReport
    Statistics forks;  ///< the same for all vertices near a segment within one radius of a branch node
    std::uint64_t missing = 0, severed = 0, crossings = 0;
    std::vector<Measure> measures;  ///< "weights" and "mesh"
};

/// One least-squares problem.
struct NnlsTiming {
    std::string what;  ///< "dense, random", "sparse, quartic tree", ...
    std::uint64_t unknowns = 0, rows = 0, entries = 0;
    int pivots = 0;
    std::uint64_t zero = 0;
    Measure measure;
};

/// Measures each scene, "chain" (straight), "Y" (of equal children), a synthetic tree or a skeleton file,
/// with the quartic kernel of supports 1.5 and 2 and Cauchy 2, each with local weights of blend 4 and 1, and
/// with global ones that are fitted to the usual points, to fewer, and to points that omit most of the upper
/// half.
std::vector<WeightsResult> bench_weights(const std::vector<std::string>& scenes, int repeat,
                                         const Context& ctx);

/// Measures 300 unknowns and 1,548 rows, dense; and global_weights on trees of 300, 3,000 and 30,000
/// segments.
std::vector<NnlsTiming> bench_nnls(int repeat, const Context& ctx);

std::string weights_markdown(const std::vector<WeightsResult>& rows);
std::string nnls_markdown(const std::vector<NnlsTiming>& rows);

}  // namespace coppice::bench
