#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>
#include <string_view>

#include "coppice/base/id.h"
#include "coppice/io/text.h"
#include "coppice/io_skeleton/mtg/measures_internal.h"

namespace coppice::mtg {

namespace {

/// Returns the column with the first of the names that occurs.
std::uint32_t find_column(const Document& document, std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names) {
        for (std::uint32_t i = 0; i < document.columns.size(); ++i) {
            if (document.columns[i].is_number && plain_name(document.columns[i].name) == name) return i;
        }
    }
    return kNoIndex;
}

}  // namespace

Measures::Measures(const Document& document) : document_(document) {
    first_value_.assign(document.vertices.size() + 1, 0);
    for (const Value& v : document.values) ++first_value_[v.vertex + 1];
    for (std::size_t i = 1; i < first_value_.size(); ++i) first_value_[i] += first_value_[i - 1];
    place_ = {find_column(document, {"xx", "x"}), find_column(document, {"yy", "y"}),
              find_column(document, {"zz", "z"})};
    radius_ = find_column(document, {"radius", "rayon", "topradius", "rad"});
    diameter_ = find_column(document, {"diameter", "diametre", "diam", "dia"});
    top_ = find_column(document, {"topdia", "topdiameter", "topdiam", "diasom", "diatop", "diamtop", "dtop"});
    base_ = find_column(document, {"bottomdia", "bottomdiameter", "botdia", "botdiameter", "basedia",
                                   "basediameter", "diabase", "diabot", "diambase", "dbase"});
    length_ = find_column(document, {"length", "len", "longueur", "longueuruc", "longuc", "long", "lg"});
    insertion_ = find_column(document, {"insertion", "insertionangle", "insangle", "alpha", "angle"});
    azimuth_ = find_column(document, {"azimuth", "azimut", "phyllotaxy", "phyllotaxis"});
}

double Measures::value(std::uint32_t vertex, std::uint32_t column) const {
    if (column == kNoIndex) return kUnknown;
    const auto begin = document_.values.begin() + first_value_[vertex];
    const auto end = document_.values.begin() + first_value_[vertex + 1];
    const auto found =
        std::lower_bound(begin, end, column, [](const Value& v, std::uint32_t c) { return v.column < c; });
    return found != end && found->column == column ? found->value : kUnknown;
}

std::optional<Vec3d> Measures::place(std::uint32_t vertex) const {
    const Vec3d p{value(vertex, place_[0]), value(vertex, place_[1]), value(vertex, place_[2])};
    if (std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z)) return std::nullopt;
    return p;
}

double Measures::end_radius(std::uint32_t vertex) const {
    for (const auto& [column, part] :
         {std::pair{radius_, 1.0}, {top_, 0.5}, {diameter_, 0.5}, {base_, 0.5}}) {
        if (const double r = part * value(vertex, column); r > 0) return r;
    }
    return kUnknown;
}

double Measures::begin_radius(std::uint32_t vertex) const {
    const double r = value(vertex, base_) / 2;
    return r > 0 ? r : kUnknown;
}

bool Measures::has_diameters() const {
    return radius_ == kNoIndex && (diameter_ != kNoIndex || top_ != kNoIndex || base_ != kNoIndex);
}

}  // namespace coppice::mtg
