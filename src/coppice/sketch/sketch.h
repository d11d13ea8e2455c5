#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "coppice/sketch/view.h"

namespace coppice {

/// The axis of a branch as somebody drew it in one picture, from where it begins to its tip.
struct Stroke {
    std::uint32_t view = 0;            ///< index of the view
    std::vector<PicturePoint> points;  ///< two or more
    std::vector<double> widths;        ///< [pixels] none; at both ends; or at every point
};

/// A branch: one stroke in each of two views or more.
struct SketchBranch {
    std::string name;                     ///< each once
    std::optional<std::uint32_t> parent;  ///< index of a branch; none for a stem
    std::vector<Stroke> strokes;          ///< of different views
    std::optional<double> attach;         ///< in [0, 1] of the parent's length; none = where it is nearest
    std::optional<std::array<double, 2>> diameters;  ///< [m] at both ends; go before widths
};

/// A tree drawn into pictures of it [Huang2017].
struct Sketch {
    std::vector<SketchView> views;       ///< two or more
    std::vector<SketchBranch> branches;  ///< one or more, in any order
};

/// Throws InvalidInput, naming the field as it is called in a file, `branches[3].parent` say: views that are
/// no cameras, names that are missing or twice there, strokes with less than two points or of an unknown or
/// repeated view, widths that are not above 0 or of another number, parents in a circle, places outside [0,
/// 1]. `source` goes before the field. O(points).
void validate(const Sketch& sketch, const std::string& source);

}  // namespace coppice
