// The readers of point files, XYZ, PTS, PTX, PLY, LAS, LAZ and PCD by their first bytes, against arbitrary
// bytes. They return points that are finite, with a finite origin, or throw coppice::Error.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "coppice/base/error.h"
#include "coppice/io/points/reader.h"

namespace {

void require(bool condition) {
    if (!condition) std::abort();
}

template <class Column>
void check_column(const Column& column, std::size_t count) {
    require(column.empty() || column.size() == count);
}

void check(const coppice::PaintedPoints& found) {
    const coppice::PointSet& points = found.points;
    check_column(found.colors, points.size());
    check_column(found.classes, points.size());
    check_column(found.intensities, points.size());
    check_column(found.return_numbers, points.size());
    require(points.size() > 0 && is_finite(points.origin));
    for (const coppice::Vec3 p : points.positions) require(is_finite(p));
    require(is_finite(points.world(points.size() - 1)));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        check(coppice::parse_painted_points({reinterpret_cast<const char*>(data), size}, "input"));
    } catch (const coppice::Error&) {  // the proper answer to a bad file
    }
    return 0;
}
