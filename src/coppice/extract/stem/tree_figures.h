#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/extract/extract_result.h"
#include "coppice/extract/stem/stem_form.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Text of a doubt, see `TreeFigures`.
inline constexpr std::string_view kNoCircle = "no circle is seen at breast height";

/// Forestry measurements of an extracted tree, and their uncertainty.
struct TreeFigures {
    double height = 0;         ///< [m] from the root to the highest point of the tree
    double height_low = 0;     ///< [m] lower bound of the 90 % interval of the height
    double height_high = 0;    ///< [m] upper bound of this interval; both are 0 without points
    double dbh = 0;            ///< [m] diameter at breast height of the skeleton; 0 if the tree is lower
    double dbh_of_points = 0;  ///< [m] diameter of circles fitted to the points; 0 if no circle was found
    double dbh_low = 0;        ///< [m] lower bound of the 90 % interval of the diameter
    double dbh_high = 0;       ///< [m] upper bound of this interval; both are 0 without a circle
    double length = 0;         ///< [m] total length of the skeleton
    double length_low = 0;     ///< [m] lower bound of the 90 % interval of the length
    double length_high = 0;    ///< [m] upper bound of this interval; both are 0 without points
    double volume = 0;         ///< [m^3] volume of the cones between its nodes
    double volume_low = 0;     ///< [m^3] lower bound of the 90 % interval of the volume
    double volume_high = 0;    ///< [m^3] upper bound of this interval
    double inferred = 0;       ///< share of the volume with a radius that is inferred rather than measured
    double form = 0;  ///< volume / half of the cylinder at breast height, for a tall tree; 0 if unknown
    std::vector<std::string> doubts;  ///< implausible properties, each a sentence without a full stop
};

/// Calls visit(name, number) for every figure, in order.
template <class Visitor>
void visit_figures(const TreeFigures& t, Visitor&& visit) {
    visit("height_m", t.height);
    visit("height_low_m", t.height_low);
    visit("height_high_m", t.height_high);
    visit("dbh_m", t.dbh);
    visit("dbh_of_points_m", t.dbh_of_points);
    visit("dbh_low_m", t.dbh_low);
    visit("dbh_high_m", t.dbh_high);
    visit("length_m", t.length);
    visit("length_low_m", t.length_low);
    visit("length_high_m", t.length_high);
    visit("volume_m3", t.volume);
    visit("volume_low_m3", t.volume_low);
    visit("volume_high_m3", t.volume_high);
    visit("inferred", t.inferred);
    visit("form", t.form);
}

/// Stem as measured in the points.
struct SeenStem {
    Vec3d foot;           ///< [m] root of the tree, in the coordinate frame of the skeleton's file
    StemDiameter breast;  ///< diameter of the points
    double height = 0;    ///< [m] height of the highest point of its tree above the foot; 0 if unknown
};

/// Computes the figures of each tree of a skeleton, in the order of its roots. `confidence` is that of its
/// nodes; a stem is assigned to the tree with its root at the foot of the stem.
///
/// The interval of the volume assumes that half of the errors of radii are common to all branches, and three
/// per cent for the approximation by cones. The interval of the length is asymmetric: where radii are
/// inferred, twigs are missing, and needles and noise may be mistaken for twigs, so that it widens in both
/// directions with the inferred share of the length; the lower bound also excludes length without points. The
/// error of the height is two spacings of the points (from their number on the surface) plus two centimetres;
/// the upper bound includes the highest point of the tree, which may be an outlier. These values were
/// calibrated on simulated scans. The form is that of a tall tree: the volume divided by 0.5 pi / 4 d^2 h,
/// times (1 - 1.3 / h)^2, because breast height is relatively high on a small tree. Doubts: no circle was
/// found at breast height of a tree above 2.6 m, the diameters of skeleton and points differ by more than 5
/// %, the form is outside 0.5 to 1.8, more than half of the volume is inferred. O(nodes).
std::vector<TreeFigures> tree_figures(const Skeleton& skeleton, std::span<const NodeConfidence> confidence,
                                      std::span<const SeenStem> stems);

/// Computes the figures of a skeleton without its points: a missing circle is not a doubt. `confidence` may
/// be empty; then no volume is inferred, and no bounds are known. O(nodes).
std::vector<TreeFigures> tree_figures(const Skeleton& skeleton, std::span<const NodeConfidence> confidence);

}  // namespace coppice
