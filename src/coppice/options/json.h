#pragma once

// Includes only the declarations of nlohmann-json: code that accesses members of a Json includes
// <nlohmann/json.hpp>.

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

#include "coppice/base/fields.h"
#include "coppice/base/option_fields.h"

namespace coppice {

/// Objects keep the order of their fields.
using Json = nlohmann::ordered_json;

/// Returns "metre", "radian", "radius" or "second"; empty for a plain number.
std::string_view name_of_unit(Unit unit);

/// Returns the number with the fewest digits that still converts to this float: 0.1, not 0.10000000149.
double shortest(float value);

/// Returns options as a JSON object with a key for every field: numbers, booleans, names of enum values,
/// positions as three numbers or null, lists of words, nested objects.
Json to_json(std::span<const OptionField> fields);

/// Reads the output of `to_json`; fields that are left out keep their values. Throws InvalidInput naming the
/// field, as in "recipe.json: field.kernel must be one of quartic, cauchy, scalis": unknown names (with the
/// closest valid spelling), wrong types, values out of range. `where` names the location of the object.
void from_json(const Json& object, std::span<const OptionField> fields, const std::string& where);

/// Describes every field: name, help, whether it is common, and the entries of `describe_value`. Nested
/// structs have the type "options" and their own list of "fields". `fields` are `option_fields` of default
/// options.
Json make_schema(std::span<const OptionField> fields);

/// Adds the type of a field, its unit, minimum and maximum, choices, and its value as the default.
void describe_value(Json& entry, const OptionField& field);

}  // namespace coppice
