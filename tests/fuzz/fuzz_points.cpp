// Feeds arbitrary bytes to the readers of point files, XYZ, PTS, PTX, PLY, LAS, LAZ, E57 and PCD by their
// first bytes. They return finite points with a finite origin, or throw coppice::Error.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "../io_points/e57_file.h"
#include "coppice/base/error.h"
#include "coppice/io_points/reader.h"

namespace {

void require(bool condition) {
    if (!condition) std::abort();
}

template <class Column>
void check_column(const Column& column, std::size_t count) {
    require(column.empty() || column.size() == count);
}

void check(const coppice::PointCloud& found) {
    const coppice::PointSet& points = found.points;
    visit_columns(found, [&](const auto& column) { check_column(column, points.size()); });
    require(points.size() > 0 && is_finite(points.origin));
    for (const coppice::Vec3 p : points.positions) require(is_finite(p));
    require(is_finite(points.world(points.size() - 1)));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        std::string bytes(reinterpret_cast<const char*>(data), size);
        if (bytes.starts_with("ASTM-E57"))
            for (std::size_t page = 0; page < size / 1024; ++page) e57_file::mend(bytes, page);
        check(coppice::parse_point_file(bytes, "input", {.ranges = true}, {.allow_truncated = true})
                  .point_cloud);
    } catch (const coppice::Error&) {  // expected for an invalid file
    }
    return 0;
}
