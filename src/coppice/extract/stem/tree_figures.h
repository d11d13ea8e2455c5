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

/// A doubt, see `TreeFigures`.
inline constexpr std::string_view kNoCircle = "no circle is seen at breast height";

/// What foresters want to know of a tree that was extracted, and how sure it is.
struct TreeFigures {
    double height = 0;         ///< [m] from the root to the highest point of the tree
    double height_low = 0;     ///< [m] with `height_high`: bounds of the true height in nine of ten cases
    double height_high = 0;    ///< [m] 0 where no points are known
    double dbh = 0;            ///< [m] diameter at breast height of the skeleton; 0: it is lower
    double dbh_of_points = 0;  ///< [m] of circles through the points; 0: none was seen
    double dbh_low = 0;        ///< [m] with `dbh_high`: bounds of the true diameter in nine of ten cases
    double dbh_high = 0;       ///< [m] 0 where no circle was seen
    double length = 0;         ///< [m] of the skeleton
    double length_low = 0;     ///< [m] with `length_high`: bounds of the true length in nine of ten cases
    double length_high = 0;    ///< [m] 0 where no points are known
    double volume = 0;         ///< [m^3] of the cones between its nodes
    double volume_low = 0;     ///< [m^3] with `volume_high`: the true volume lies between in nine of ten
    double volume_high = 0;    ///< [m^3]
    double inferred = 0;       ///< share of the volume whose radius is more what trees are like than measured
    double form = 0;  ///< volume over half of the cylinder on breast height, as of a tall tree; 0: unknown
    std::vector<std::string> doubts;  ///< what is not plausible, a sentence without a full stop each
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

/// A stem as the points show it.
struct SeenStem {
    Vec3d foot;           ///< [m] in the frame of the skeleton's file: its root
    StemDiameter breast;  ///< of the points
    double height = 0;    ///< [m] of the highest point of its tree above the foot; 0: unknown
};

/// The figures of each tree of a skeleton, in the order of its roots. `confidence` is that of its nodes;
/// stems belong to the tree whose root lies at their foot.
///
/// The interval of the volume takes the errors of radii for half in common to all branches, and three per
/// cent for what cones leave out. That of the length is lopsided: where radii are inferred, twigs are
/// missing, and needles and scatter may be taken for twigs, so that it widens upward and downward with the
/// share of the length that is; what no point supports may not be there at all. The height is known to two
/// spacings of the points (from their number on the surface) and two centimetres; a tree may reach as high as
/// its points, which may be strays. These numbers are those that hold on simulated scans. The form is that of
/// a tall tree: the volume over 0.5 pi / 4 d^2 h, times (1 - 1.3 / h)^2, since breast height is high up a
/// small tree. Doubts: no circle was seen at breast height of a tree above 2.6 m, the diameters of skeleton
/// and points differ by over 5 %, the form is not within 0.5 to 1.8, over half of the volume is inferred.
/// O(nodes).
std::vector<TreeFigures> tree_figures(const Skeleton& skeleton, std::span<const NodeConfidence> confidence,
                                      std::span<const SeenStem> stems);

/// The same of a skeleton alone, without its points: that no circle was seen is no doubt. `confidence` may be
/// empty; then nothing is inferred, and no bounds are known. O(nodes).
std::vector<TreeFigures> tree_figures(const Skeleton& skeleton, std::span<const NodeConfidence> confidence);

}  // namespace coppice
