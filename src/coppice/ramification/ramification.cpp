#include "coppice/ramification/ramification.h"

#include <algorithm>
#include <chrono>

#include "coppice/base/check_fields.h"
#include "coppice/ramification/paste_internal.h"

namespace coppice {
namespace {

using namespace ramification_internal;

/// The inverse of the mean radius of a square tube after so many subdivisions, over half its side.
double widening(int levels) {
    constexpr double kOne = 1.030, kTwo = 0.953, kThree = 0.936, kLimit = 0.930;
    return 1 / (levels <= 1 ? kOne : levels == 2 ? kTwo : levels == 3 ? kThree : kLimit);
}

class Timer {
  public:
    /// Seconds since the last call, or since it was made.
    double lap() {
        const auto now = std::chrono::steady_clock::now();
        const std::chrono::duration<double> took = now - start_;
        start_ = now;
        return took.count();
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

RamificationMesh build_ramifications(const RamificationInput& input, const ControlOptions& ends, int levels,
                                     const RamificationOptions& options, const Context& ctx) {
    check_fields(options, "ramifications");
    if (ends.base == BaseShape::open)
        throw InvalidInput("mesh: ramifications make closed surfaces only; choose base flat or round");
    RamificationMesh out;
    Timer timer;
    const Branches branches(input.skeleton, input.pasted);
    out.report.branches = branches.count();
    MainMesh main =
        build_main_mesh(branches, input.skeleton, ends, widening(levels), options, out.report, ctx);
    main.control.cage.origin = input.skeleton.origin();
    main.control.region_node.assign(input.source.begin(), input.source.end());
    out.report.connection_seconds = timer.lap();
    Subdivided subdivided(main, ctx);
    out.report.subdivision_seconds = timer.lap();
    out.control = std::move(subdivided).paste(branches, out.report, ctx);
    out.report.paste_seconds = timer.lap();
    return out;
}

}  // namespace coppice
