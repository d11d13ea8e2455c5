// Points of PLY: the element `vertex` with its attributes; in ray clouds, every vertex is the end of a ray.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/io/ply_header.h"
#include "coppice/io_points/read_internal.h"

namespace coppice::io_internal {
namespace {

using Property = std::optional<std::size_t>;
using Properties = std::optional<std::array<std::size_t, 3>>;

/// The properties of a vertex that are stored.
class Columns {
  public:
    Columns(const PlyElement& element, const std::string& source) : element_(element) {
        const auto x = element.find({"x"}), y = element.find({"y"}), z = element.find({"z"});
        if (!x || !y || !z)
            throw InvalidInput(fmt::format("{}: the vertices lack a property x, y or z", source));
        place = {*x, *y, *z};
        for (const std::size_t property : place) {
            if (element.properties[property].is_list())
                throw InvalidInput(fmt::format("{}: the coordinates of the vertices are lists", source));
        }
        distance = scalar({"distance"});
        classification =
            scalar({"classification", "scalar_Classification", "scalar_classification", "class"});
        intensity = scalar({"intensity", "scalar_Intensity", "scalar_intensity", "reflectance",
                            "scalar_Reflectance", "scalar_reflectance"});
        return_number = scalar({"return_number"});
        return_count = scalar({"number_of_returns"});
        tree_id = tree_ids();
        color = three(byte("red"), byte("green"), byte("blue"));
        to_sensor = three(scalar({"nx"}), scalar({"ny"}), scalar({"nz"}));
        alpha = byte("alpha");
        if (!alpha || !scalar({"time"})) to_sensor.reset();
    }

    std::array<std::size_t, 3> place{};
    Property distance, classification, intensity, return_number, return_count, tree_id, alpha;
    Properties color;
    Properties to_sensor;  ///< of a possible ray cloud, which has `time` and `alpha` too

  private:
    Property scalar(std::initializer_list<std::string_view> names) const {
        const auto property = element_.find(names);
        return property && !element_.properties[*property].is_list() ? property : std::nullopt;
    }
    Property byte(std::string_view name) const {
        const auto property = scalar({name});
        return property && element_.properties[*property].type == PlyType::uint8 ? property : std::nullopt;
    }
    Property tree_ids() const {
        std::vector<std::string> names;
        for (const PlyProperty& p : element_.properties) names.push_back(p.is_list() ? "" : p.name);
        return find_tree_ids(names);
    }
    static Properties three(Property a, Property b, Property c) {
        if (a && b && c) return std::array{*a, *b, *c};
        return {};
    }

    const PlyElement& element_;
};

/// Distinguishes ray clouds from other points with time, normals and alpha, and removes rays without return.
class RayFilter {
  public:
    explicit RayFilter(const Columns& columns) : columns_(columns) {}

    void add(const PlyRow& row) {
        if (!columns_.to_sensor) return;
        constexpr double kRounding = 0.02;  // tolerance for normals written with few digits
        const auto [x, y, z] = *columns_.to_sensor;
        const Vec3d v{row.scalar(x), row.scalar(y), row.scalar(z)};
        const double square = length_squared(v);
        are_rays_ = are_rays_ || (square > 0 && std::abs(square - 1) > kRounding);
        returned_.push_back(row.scalar(*columns_.alpha) > 0 ? 1 : 0);
    }

    void finish(FoundPoints& found, const std::string& source) {
        if (!are_rays_) return;
        found.format = "ray cloud (PLY)";
        const std::size_t rays = found.places.size();
        keep_values(found.places, returned_);
        visit_columns(found.known, [&](auto& column) { keep_values(column, returned_); });
        found.without_return = rays - found.places.size();
        if (found.places.empty())
            throw InvalidInput(fmt::format(
                "{}: it is a ray cloud, and none of its {} rays has a return: the alpha of all is 0", source,
                rays));
    }

  private:
    const Columns& columns_;
    std::vector<std::uint8_t> returned_;
    bool are_rays_ = false;
};

FoundPoints read_vertices(PlyRows& rows, const PlyElement& element, const std::string& source) {
    const Columns columns(element, source);
    RayFilter rays(columns);
    FoundPoints found{.format = "PLY"};
    found.places.reserve(element.count);
    PointCloud& known = found.known;
    PlyRow row;
    for (std::uint64_t i = 0; i < element.count; ++i) {
        rows.read(row);
        const auto [x, y, z] = columns.place;
        found.places.push_back({row.scalar(x), row.scalar(y), row.scalar(z)});
        if (!fits_points(found.places.back())) {
            throw InvalidInput(fmt::format("{}: point {} is not finite or beyond 1e30", source, i));
        }
        if (columns.distance) known.distances.push_back(static_cast<float>(row.scalar(*columns.distance)));
        if (columns.classification) known.classes.push_back(to_byte(row.scalar(*columns.classification)));
        if (columns.intensity)
            known.intensities.push_back(static_cast<float>(row.scalar(*columns.intensity)));
        if (columns.return_number)
            known.return_numbers.push_back(to_byte(row.scalar(*columns.return_number)));
        if (columns.return_count) known.return_counts.push_back(to_byte(row.scalar(*columns.return_count)));
        if (columns.tree_id) known.tree_ids.push_back(to_tree_id(row.scalar(*columns.tree_id)));
        rays.add(row);
        if (!columns.color) continue;
        const auto byte = [&](std::size_t k) { return to_byte(row.scalar((*columns.color)[k])); };
        known.colors.push_back({byte(0), byte(1), byte(2)});
    }
    rays.finish(found, source);
    return found;
}

}  // namespace

FoundPoints parse_ply_points(std::string_view bytes, const std::string& source, const Context& ctx) {
    const PlyHeader header = parse_ply_header(bytes, source);
    PlyRows rows(bytes, header, source, ctx);
    for (const PlyElement& element : header.elements) {
        rows.begin_element(element);
        if (element.name == "vertex") return read_vertices(rows, element, source);
        rows.skip_element();
    }
    throw InvalidInput(fmt::format("{}: it has no element vertex", source));
}

}  // namespace coppice::io_internal
