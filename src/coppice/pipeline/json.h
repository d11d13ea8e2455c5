#pragma once

// Includes no more of nlohmann-json than its names: who looks into a Json includes <nlohmann/json.hpp>.

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

#include "coppice/base/fields.h"
#include "coppice/pipeline/option_fields.h"

namespace coppice {

/// Objects keep the order of their fields.
using Json = nlohmann::ordered_json;

/// "metre", "radian", "radius", "second"; empty for a plain number.
std::string_view name_of_unit(Unit unit);

/// The number with the fewest digits that still gives this float: 0.1, not 0.10000000149.
double shortest(float value);

/// Options as a JSON object with a key for every field: numbers, booleans, names of enum values, places as
/// three numbers or null, lists of words, nested objects.
Json to_json(std::span<const OptionField> fields);

/// Reads what `to_json` writes; fields that are left out keep their values. Throws InvalidInput naming
/// the field, as in "recipe.json: field.kernel must be one of quartic, cauchy, scalis": unknown names (with
/// the nearest valid spelling), wrong types, values out of range. `where` says where the object stands.
void from_json(const Json& object, std::span<const OptionField> fields, const std::string& where);

/// Describes every field: name, help, whether it is common, and what `describe_value` adds. Nested structs
/// have the type "options" and their own list of "fields". `fields` are `option_fields` of default options.
Json schema_of(std::span<const OptionField> fields);

/// Adds the type of a field, its unit, least and greatest value, choices, and its value as the default.
void describe_value(Json& entry, const OptionField& field);

}  // namespace coppice
