#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/ramification/branches_internal.h"
#include "coppice/ramification/ramification.h"

namespace coppice::ramification_internal {

/// A branch as seen from the one that it leaves. Lengths are along that one, but for `exit_arc`.
struct Lateral {
    std::uint32_t branch = 0;
    double center = 0;    ///< where its axis comes out
    Vec3d out;            ///< unit, across the parent there: the way to where it comes out
    Vec3d exit;           ///< where its axis comes out
    double exit_arc = 0;  ///< the same along its own path
    double radius = 0;    ///< its own there
    double half = 0;      ///< of its footprint along the parent
    bool on_cap = false;  ///< it comes out over an end of the parent
    bool additional = false;
    std::uint32_t row = 0, face = 0;  ///< of its unit, when it is connectable
};

/// Where a lateral's axis leaves the parent's cone.
Lateral find_lateral(const Branches& branches, std::uint32_t lateral);

/// A piece of a branch from which laterals leave. The one that is thickest is in the middle of face 0.
struct Unit {
    double center = 0, start = 0, end = 0;       ///< [m] along the branch
    double radius = 0;                           ///< of the branch at the centre
    Vec3d out;                                   ///< where face 0 looks
    double spread = 0;                           ///< [rad] from the middle of face 0 to its corners
    std::vector<double> rings;                   ///< [m] along the branch, ascending from start to end
    std::uint32_t first_lateral = 0, count = 0;  ///< in UnitPlan::laterals

    /// Of four faces, each between two rings.
    std::uint32_t rows() const { return static_cast<std::uint32_t>(rings.size()) - 1; }
};

/// Units in order along a branch, apart from each other, and their laterals.
struct UnitPlan {
    std::vector<Lateral> laterals;
    std::vector<Unit> units;
};

/// Groups the laterals of a branch in units, classifies them, and shares the space between the units; these
/// stay within [from, to]. Adds to the objective.
UnitPlan plan_units(const Branches& branches, std::uint32_t branch, double from, double to, double alpha,
                    const RamificationOptions& options, RamificationReport& report);

}  // namespace coppice::ramification_internal
