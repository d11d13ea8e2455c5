#include "coppice/studio/show/slice_internal.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/implicit/solid/field_values.h"

namespace coppice {
namespace {

constexpr int kMinSize = 2, kMaxSize = 1024;

/// A rectangle perpendicular to an axis: its corner, and the vectors along its sides.
struct Rectangle {
    Vec3d corner, along, up;
};

Rectangle compute_rectangle(const Box3& box, const SliceOptions& options) {
    const Vec3d size(box.size());
    Rectangle out{.corner = Vec3d(box.low), .along = {size.x, 0, 0}, .up = {0, 0, size.z}};
    if (options.axis == SliceAxis::x) {
        out.corner.x = options.at;
        out.along = {0, size.y, 0};
    } else if (options.axis == SliceAxis::y) {
        out.corner.y = options.at;
    } else {
        out.corner.z = options.at;
        out.up = {0, size.y, 0};
    }
    return out;
}

Json make_json(Vec3d v) { return {v.x, v.y, v.z}; }

}  // namespace

void check_slice(const SliceOptions& options) {
    if (!std::isfinite(options.at)) throw InvalidInput("a slice requires a position on its axis, in metres");
    if (options.size < kMinSize || options.size > kMaxSize)
        throw InvalidInput("a slice requires 2 to 1024 samples along its longer side");
}

std::string encode_slice(const Solid& solid, const SliceOptions& options, const GeometryHead& head,
                         const Context& ctx) {
    check_slice(options);
    const SolidField field(solid);
    const Rectangle plane = compute_rectangle(field.bounds(), options);
    const double along = length(plane.along), up = length(plane.up), longer = std::max(along, up);
    const auto samples = [&](double side) {
        return std::max(1, static_cast<int>(std::lround(longer > 0 ? options.size * side / longer : 1)));
    };
    const int width = samples(along), height = samples(up);
    std::vector<Vec3> places;
    places.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x)
            places.emplace_back(plane.corner + plane.along * ((x + 0.5) / width) +
                                plane.up * ((y + 0.5) / height));
    }
    const std::vector<float> values = values_at(field, places, ctx);
    const auto [low, high] = std::ranges::minmax(values);
    GeometryWriter writer("slice", head, {});
    Json& header = writer.header();
    header["width"] = width;
    header["height"] = height;
    header["corner"] = make_json(plane.corner);
    header["along"] = make_json(plane.along);
    header["up"] = make_json(plane.up);
    header["level"] = field.level();
    header["low"] = low;
    header["high"] = high;
    writer.add("value", values, 1);
    return writer.finish();
}

}  // namespace coppice
