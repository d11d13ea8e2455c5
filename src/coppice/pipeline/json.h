#pragma once

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/base/fields.h"
#include "coppice/pipeline/spelling.h"

namespace coppice {

/// Objects keep the order of their fields.
using Json = nlohmann::ordered_json;

/// A struct that describes itself by `visit_fields`; a member may be such a struct again.
template <class T>
concept OptionStruct = requires(const T& options) {
    visit_fields(options, [](const Field&, const auto&) {});
};

/// "metre", "radian", "radius", "second"; empty for a plain number.
std::string_view name_of_unit(Unit unit);

/// The number with the fewest digits that still gives this float: 0.1, not 0.10000000149.
double shortest(float value);

/// An options struct as a JSON object with a key for every field: numbers, booleans, names of enum values,
/// nested objects.
template <OptionStruct Options>
Json to_json(const Options& options) {
    Json out = Json::object();
    visit_fields(options, [&](const Field& field, const auto& value) {
        using T = std::remove_cvref_t<decltype(value)>;
        Json& slot = out[std::string(field.name)];
        if constexpr (OptionStruct<T>) {
            slot = to_json(value);
        } else if constexpr (NamedEnum<T>) {
            slot = name_of(value);
        } else if constexpr (std::is_same_v<T, float>) {
            slot = shortest(value);
        } else {
            slot = value;
        }
    });
    return out;
}

namespace pipeline_internal {

void check_keys(const Json& object, const std::vector<std::string>& known, const std::string& where);
bool read_bool(const Json& value, const std::string& where);
double read_number(const Json& value, const Field& field, bool whole, const std::string& where);
std::size_t read_name(const Json& value, std::span<const std::string_view> names, const std::string& where);

template <class T>
void read(const Json& value, const Field& field, T& out, const std::string& where) {
    if constexpr (NamedEnum<T>) {
        out = static_cast<T>(read_name(value, EnumNames<T>::names, where));
    } else if constexpr (std::is_same_v<T, bool>) {
        out = read_bool(value, where);
    } else {
        out = static_cast<T>(read_number(value, field, std::is_same_v<T, int>, where));
    }
}

}  // namespace pipeline_internal

/// Reads what `to_json` writes; fields that are left out keep their defaults. Throws InvalidInput naming the
/// field, as in "recipe.json: field.kernel must be one of quartic, cauchy, scalis": unknown names (with the
/// nearest valid spelling), wrong types, values out of range. `where` says where the object stands.
template <OptionStruct Options>
Options from_json(const Json& object, const std::string& where) {
    Options options;
    std::vector<std::string> known;
    visit_fields(options, [&](const Field& field, auto&) { known.emplace_back(field.name); });
    pipeline_internal::check_keys(object, known, where);
    visit_fields(options, [&](const Field& field, auto& value) {
        using T = std::remove_cvref_t<decltype(value)>;
        const auto found = object.find(std::string(field.name));
        if (found == object.end()) return;
        const std::string place = fmt::format("{}: {}", where, field.name);
        if constexpr (OptionStruct<T>) {
            value = from_json<T>(*found, place);
        } else {
            pipeline_internal::read(*found, field, value, place);
        }
    });
    return options;
}

/// Describes every field of an options struct: name, help, type, unit, least and greatest value, choices,
/// default. Nested structs have the type "options" and their own list of "fields".
template <OptionStruct Options>
Json schema_of(const Options& defaults = {}) {
    Json fields = Json::array();
    visit_fields(defaults, [&](const Field& field, const auto& value) {
        using T = std::remove_cvref_t<decltype(value)>;
        Json entry{{"name", field.name}, {"help", field.help}};
        if constexpr (OptionStruct<T>) {
            entry["type"] = "options";
            entry["fields"] = schema_of(value);
        } else if constexpr (NamedEnum<T>) {
            entry["type"] = "choice";
            entry["choices"] = EnumNames<T>::names;
            entry["default"] = name_of(value);
        } else if constexpr (std::is_same_v<T, bool>) {
            entry["type"] = "bool";
            entry["default"] = value;
        } else {
            entry["type"] = std::is_same_v<T, int> ? "int" : "float";
            entry["unit"] = name_of_unit(field.unit);
            if (field.low < field.high) {
                entry["low"] = field.low;
                entry["high"] = field.high;
            }
            if constexpr (std::is_same_v<T, float>) {
                entry["default"] = shortest(value);
            } else {
                entry["default"] = value;
            }
        }
        fields.push_back(std::move(entry));
    });
    return fields;
}

}  // namespace coppice
