#pragma once

#include <array>
#include <string_view>

#include "coppice/base/fields.h"
#include "coppice/base/vec.h"

namespace coppice {

/// Up axis of a file. In memory it is z. Conversions preserve the handedness.
enum class FileUp {
    z,  ///< surveying and CAD
    y   ///< games and OBJ files of Blender
};

template <>
struct EnumNames<FileUp> {
    static constexpr std::array<std::string_view, 2> names{"z", "y"};
};

/// Converts a vector of a file to z up.
template <class T>
constexpr BasicVec3<T> from_file(BasicVec3<T> p, FileUp up) {
    return up == FileUp::y ? BasicVec3<T>{p.x, -p.z, p.y} : p;
}

/// Converts a vector with z up to the up axis of a file.
template <class T>
constexpr BasicVec3<T> to_file(BasicVec3<T> p, FileUp up) {
    return up == FileUp::y ? BasicVec3<T>{p.x, p.z, -p.y} : p;
}

/// Converts all points read from a file to z up.
template <class Points>
void turn_from_file(Points& points, FileUp up) {
    if (up == FileUp::z) return;
    for (auto& p : points.positions) p = from_file(p, up);
    points.origin = from_file(points.origin, up);
}

/// Converts all points to the up axis of a file.
template <class Points>
void turn_to_file(Points& points, FileUp up) {
    if (up == FileUp::z) return;
    for (auto& p : points.positions) p = to_file(p, up);
    points.origin = to_file(points.origin, up);
}

}  // namespace coppice
