#include "coppice/io_skeleton/rsml/units_internal.h"

#include <cmath>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "coppice/base/id.h"
#include "coppice/io/text.h"
#include "coppice/io_skeleton/length_unit.h"

namespace coppice::rsml {

namespace {

/// Returns the length of the unit in metres; 0 if it is not a length. Some programs write "dpi" for a
/// resolution per inch.
double metres_of_unit(std::string_view unit) {
    const std::string name = plain_name(unit);
    if (name == "dm") return 0.1;
    if (name == "dpi" || name == "ppi") return to_metres(LengthUnit::inch);
    const auto known = length_unit_of_word(unit);
    return known ? to_metres(*known) : 0;
}

}  // namespace

double metres_per_pixel(const Document& document, std::vector<std::string>& notes) {
    constexpr double kSmallUnit = 1e-5;  // [m]
    const double unit = metres_of_unit(document.unit);
    if (unit == 0) {
        notes.push_back(fmt::format(
            "the file uses {} of unknown size: each was assumed to be a metre; set scale for another length",
            document.unit.empty() ? "pixels" : in_quotes(document.unit)));
        return 1;
    }
    const double resolution = document.resolution;
    if (!(resolution > 0) || !std::isfinite(resolution)) return unit;
    return resolution < 1 || unit < kSmallUnit ? unit * resolution : unit / resolution;
}

Upright::Upright(const Document& document, std::vector<std::string>& notes) {
    if (document.software == "Coppice") return;
    Vec3d run;
    for (const Root& root : document.roots) {
        if (root.parent != kNoIndex || root.point_count == 0) continue;
        run += document.points[root.first_point + root.point_count - 1] - document.points[root.first_point];
    }
    if (!document.is_flat && !(std::abs(run.y) > std::abs(run.z))) return;
    down_ = run.y < 0 ? -1 : 1;
    notes.push_back(
        fmt::format("the y axis of the file, which points {}, was rotated to z", down_ > 0 ? "down" : "up"));
}

}  // namespace coppice::rsml
