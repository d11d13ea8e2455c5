#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "coppice/sketch/view.h"

namespace coppice {

/// The axis of a branch as drawn in one image, from its start to its tip.
struct Stroke {
    std::uint32_t view = 0;            ///< index of the view
    std::vector<PicturePoint> points;  ///< at least two
    std::vector<double> widths;        ///< [pixels] empty, one at each end, or one per point
};

/// A branch with one stroke in each of at least two views.
struct SketchBranch {
    std::string name;                     ///< unique
    std::optional<std::uint32_t> parent;  ///< index of a branch; none for a stem
    std::vector<Stroke> strokes;          ///< in different views
    std::optional<double>
        attach;  ///< start as a fraction of the length of the parent, in [0, 1]; none = at the closest point
    std::optional<std::array<double, 2>> diameters;  ///< [m] at both ends; replace the widths
};

/// A tree drawn in several images [Huang2017].
struct Sketch {
    std::vector<SketchView> views;       ///< at least two
    std::vector<SketchBranch> branches;  ///< at least one, in any order
};

/// Throws InvalidInput naming the field as in the file, for example `branches[3].parent`, for: invalid
/// cameras, missing or duplicate names, strokes with fewer than two points or of an unknown or repeated view,
/// widths that are not positive or do not match the number of points, cyclic parents, and values outside [0,
/// 1]. `source` precedes the field. O(points).
void validate(const Sketch& sketch, const std::string& source);

}  // namespace coppice
