#pragma once

#include <cstdint>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/ramification/branches_internal.h"
#include "coppice/ramification/ramification.h"

namespace coppice::ramification_internal {

/// Branch relative to its parent branch. Lengths are along the parent, except `exit_arc`.
struct Lateral {
    std::uint32_t branch = 0;
    double center = 0;    ///< position where its axis exits
    Vec3d out;            ///< unit vector across the parent there, towards the exit
    Vec3d exit;           ///< exit of its axis
    double exit_arc = 0;  ///< arc length of the exit along its own path
    double radius = 0;    ///< its own radius there
    double half = 0;      ///< half of its footprint along the parent
    bool on_cap = false;  ///< whether it exits over an end of the parent
    bool additional = false;
    std::uint32_t row = 0, face = 0;  ///< in its unit, if it is connectable
};

/// Computes where the axis of a lateral exits the cone of its parent.
Lateral find_lateral(const Branches& branches, std::uint32_t lateral);

/// Section of a branch with laterals. The thickest one is in the middle of face 0.
struct Unit {
    double center = 0, start = 0, end = 0;       ///< [m] along the branch
    double radius = 0;                           ///< radius of the branch at the centre
    Vec3d out;                                   ///< direction of face 0
    double spread = 0;                           ///< [rad] angle from the middle of face 0 to its corners
    std::vector<double> rings;                   ///< [m] along the branch, ascending from start to end
    std::uint32_t first_lateral = 0, count = 0;  ///< in UnitPlan::laterals

    /// Returns the number of rows of four faces, each between two rings.
    std::uint32_t rows() const { return static_cast<std::uint32_t>(rings.size()) - 1; }
};

/// Units in order along a branch, without overlaps, and their laterals.
struct UnitPlan {
    std::vector<Lateral> laterals;
    std::vector<Unit> units;
};

/// Groups the laterals of a branch in units, classifies them, and divides the space between the units; these
/// remain within [from, to]. Adds to the objective.
UnitPlan plan_units(const Branches& branches, std::uint32_t branch, double from, double to, double alpha,
                    const RamificationOptions& options, RamificationReport& report);

}  // namespace coppice::ramification_internal
