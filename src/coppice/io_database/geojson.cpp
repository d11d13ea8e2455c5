#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "coppice/io_database/map_writers_internal.h"
#include "coppice/options/json.h"

namespace coppice::io_internal {
namespace {

struct ToJson {
    Json operator()(std::monostate) const { return nullptr; }
    template <class Value>
    Json operator()(const Value& value) const {
        return value;
    }
};

Json compute_geometry(const MapFeature& feature, MapGeometry geometry) {
    if (geometry == MapGeometry::points) {
        const Vec3d p = feature.corners.front();
        return {{"type", "Point"}, {"coordinates", {p.x, p.y, p.z}}};
    }
    Json ring = Json::array();
    for (const Vec3d p : feature.corners) ring.push_back({p.x, p.y});
    ring.push_back(ring.front());
    return {{"type", "Polygon"}, {"coordinates", Json::array({ring})}};
}

Json to_feature(const MapFeature& feature, const MapLayer& layer) {
    Json properties{{"layer", layer.name}};
    for (std::size_t c = 0; c < layer.columns.size(); ++c)
        properties[layer.columns[c]] = std::visit(ToJson(), feature.values[c]);
    return {{"type", "Feature"},
            {"properties", properties},
            {"geometry", compute_geometry(feature, layer.geometry)}};
}

}  // namespace

std::string encode_geojson(std::span<const MapLayer> layers, const MapCrs& crs, const Context& ctx) {
    Json features = Json::array();
    for (const MapLayer& layer : layers) {
        for (const MapFeature& feature : layer.features) {
            ctx.throw_if_cancelled();
            features.push_back(to_feature(feature, layer));
        }
    }
    Json out{{"type", "FeatureCollection"}};
    if (crs.epsg > 0) {
        out["crs"] = {{"type", "name"},
                      {"properties", {{"name", fmt::format("urn:ogc:def:crs:EPSG::{}", crs.epsg)}}}};
    }
    out["features"] = std::move(features);
    return out.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace coppice::io_internal
