#include "coppice/ramification/ramification.h"

#include <algorithm>
#include <chrono>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/ramification/paste_internal.h"

namespace coppice {
namespace {

using namespace ramification_internal;

/// Returns half the side of a square tube divided by its mean radius after this number of subdivisions.
double widening(int levels) {
    constexpr double kOne = 1.030, kTwo = 0.953, kThree = 0.936, kLimit = 0.930;
    return 1 / (levels <= 1 ? kOne : levels == 2 ? kTwo : levels == 3 ? kThree : kLimit);
}

class Timer {
  public:
    /// Returns the seconds since the last call or the construction.
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

RamificationMesh build_ramifications(const Skeleton& skeleton, const ControlOptions& ends, int levels,
                                     const RamificationOptions& options, const Context& ctx,
                                     std::span<const NodeId> round_roots) {
    check_fields(options, "ramifications");
    if (ends.base == BaseShape::open)
        throw InvalidInput("mesh: ramifications make closed surfaces only; choose base flat or round");
    RamificationReport report;
    Timer timer;
    const Branches branches(skeleton);
    report.branches = branches.count();
    MainMesh main =
        build_main_mesh(branches, skeleton, round_roots, ends, widening(levels), options, report, ctx);
    main.control.cage.origin = skeleton.origin();
    report.connection_seconds = timer.lap();
    Subdivided subdivided(main, ctx);
    report.subdivision_seconds = timer.lap();
    ControlMesh control = std::move(subdivided).paste(branches, report, ctx);
    report.paste_seconds = timer.lap();
    control.region_node = main.tubes.source(branches);
    return {std::move(control), main.tubes.skeleton(skeleton.origin()), main.tubes.sides(),
            main.tubes.wrapping(branches, skeleton.size()), report};
}

void list_fields(RamificationOptions& o, FieldList& list) {
    list.add(
        Field{"all_additional", "Paste every lateral instead of making most of them part of the main mesh."},
        o.all_additional);
    list.add(
        Field{"no_connection_optimisation", "Keep ramification units as cubes, even if neighbours overlap."},
        o.no_connection_optimisation);
    list.add(Field{"printed_angles",
                   "Compute angles between siblings modulo 45 degrees as printed, so that only one of them "
                   "connects."},
             o.printed_angles);
    list.add(
        Field{"additional_threshold", "Cost of a connection above which two ramification units are merged.",
              coppice::Unit::none, 0, 100},
        o.additional_threshold);
}

}  // namespace coppice
