#pragma once

#include <array>
#include <string_view>

#include "coppice/base/fields.h"
#include "coppice/base/vec.h"

namespace coppice {

/// The axis that points up in a file; here it is z. Neither turns right hands into left ones.
enum class FileUp {
    z,  ///< as in surveying and CAD
    y   ///< as in games and in OBJ files of Blender
};

template <>
struct EnumNames<FileUp> {
    static constexpr std::array<std::string_view, 2> names{"z", "y"};
};

/// A vector of a file as it is here.
template <class T>
constexpr BasicVec3<T> from_file(BasicVec3<T> p, FileUp up) {
    return up == FileUp::y ? BasicVec3<T>{p.x, -p.z, p.y} : p;
}

/// A vector from here as it stands in a file.
template <class T>
constexpr BasicVec3<T> to_file(BasicVec3<T> p, FileUp up) {
    return up == FileUp::y ? BasicVec3<T>{p.x, p.z, -p.y} : p;
}

/// Turns all points of something that a file holds.
template <class Points>
void turn_from_file(Points& points, FileUp up) {
    if (up == FileUp::z) return;
    for (auto& p : points.positions) p = from_file(p, up);
    points.origin = from_file(points.origin, up);
}

/// Turns them to how a file is to hold them.
template <class Points>
void turn_to_file(Points& points, FileUp up) {
    if (up == FileUp::z) return;
    for (auto& p : points.positions) p = to_file(p, up);
    points.origin = to_file(points.origin, up);
}

}  // namespace coppice
