#include "coppice/options/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "coppice/base/error.h"
#include "coppice/options/renamed.h"
#include "coppice/options/spelling.h"

namespace coppice {
namespace {

Json make_json(const bool* value) { return *value; }
Json make_json(const int* value) { return *value; }
Json make_json(const float* value) { return shortest(*value); }
Json make_json(const ChoiceRef& choice) { return choice.name(); }
Json make_json(const std::optional<Vec3d>* place) {
    return *place ? Json{(*place)->x, (*place)->y, (*place)->z} : Json(nullptr);
}
Json make_json(const std::vector<std::string>* words) { return *words; }
Json make_json(const std::vector<OptionField>& fields) { return to_json(fields); }

void check_keys(const Json& object, std::span<const OptionField> fields, const std::string& where) {
    if (!object.is_object()) throw InvalidInput(where + " must be an object with named fields");
    std::vector<std::string> known;
    for (const OptionField& field : fields) known.emplace_back(field.field.name);
    for (const auto& [key, value] : object.items()) {
        if (std::ranges::find(known, key) != known.end()) continue;
        if (std::ranges::find(known, present_name(key)) != known.end()) continue;
        const std::string quoted = Json(key).dump();  // keys may contain line breaks
        throw InvalidInput(fmt::format("{}: there is no field {}{}", where,
                                       std::string_view(quoted).substr(1, quoted.size() - 2),
                                       did_you_mean(key, known)));
    }
}

/// The value of a field under its name, or else under a former one.
Json::const_iterator find_value(const Json& object, std::string_view name) {
    const auto found = object.find(std::string(name));
    if (found != object.end()) return found;
    auto at = object.begin();
    while (at != object.end() && present_name(at.key()) != name) ++at;
    return at;
}

double read_number(const Json& value, const Field& field, bool whole, const std::string& where) {
    const bool right_kind = whole ? value.is_number_integer() : value.is_number();
    if (!right_kind)
        throw InvalidInput(fmt::format("{} must be a {}", where, whole ? "whole number" : "number"));
    const double number = value.get<double>();
    const double limit = whole ? std::numeric_limits<int>::max() : std::numeric_limits<float>::max();
    const bool ranged = field.low < field.high;
    const double low = ranged ? field.low : -limit, high = ranged ? field.high : limit;
    if (number >= low && number <= high) return number;
    throw InvalidInput(fmt::format("{} must be between {} and {}, but is {}", where, low, high, number));
}

/// Reads the value of one field; `where` names it in messages.
class ValueReader {
  public:
    ValueReader(const Json& value, const Field& field, const std::string& where)
        : value_(value), field_(field), where_(where) {}

    void operator()(bool* out) const {
        if (!value_.is_boolean()) throw InvalidInput(where_ + " must be true or false");
        *out = value_.get<bool>();
    }
    void operator()(int* out) const { *out = static_cast<int>(read_number(value_, field_, true, where_)); }
    void operator()(float* out) const {
        *out = static_cast<float>(read_number(value_, field_, false, where_));
    }
    void operator()(const ChoiceRef& choice) const {
        if (value_.is_string()) {
            const auto found = std::ranges::find(choice.names, value_.get_ref<const std::string&>());
            if (found != choice.names.end())
                return choice.set(static_cast<std::size_t>(found - choice.names.begin()));
        }
        throw InvalidInput(fmt::format("{} must be one of {}", where_, fmt::join(choice.names, ", ")));
    }
    void operator()(std::optional<Vec3d>* out) const {
        if (value_.is_null()) return out->reset();
        const auto is_number = [](const Json& number) { return number.is_number(); };
        if (!value_.is_array() || value_.size() != 3 || !std::ranges::all_of(value_, is_number))
            throw InvalidInput(where_ + " must be a list of three numbers");
        *out = Vec3d{value_[0].get<double>(), value_[1].get<double>(), value_[2].get<double>()};
    }
    void operator()(std::vector<std::string>* out) const {
        const auto is_text = [](const Json& word) { return word.is_string(); };
        if (!value_.is_array() || !std::ranges::all_of(value_, is_text))
            throw InvalidInput(where_ + " must be a list of texts");
        *out = value_.get<std::vector<std::string>>();
    }
    void operator()(const std::vector<OptionField>& fields) const { from_json(value_, fields, where_); }

  private:
    const Json& value_;
    const Field& field_;
    const std::string& where_;
};

std::string_view type_name(const OptionRef& ref) {
    static constexpr std::array<std::string_view, std::variant_size_v<OptionRef>> kNames{
        "bool", "int", "float", "choice", "place", "texts", "options"};
    return kNames[ref.index()];
}

}  // namespace

std::string_view name_of_unit(Unit unit) {
    static constexpr std::array<std::string_view, 5> kNames{"none", "metre", "radian", "radius", "second"};
    return kNames[static_cast<std::size_t>(unit)];
}

double shortest(float value) {
    if (!std::isfinite(value)) return double{value};
    std::array<char, 32> text{};
    const auto written = std::to_chars(text.data(), text.data() + text.size(), value);
    double number = 0;
    std::from_chars(text.data(), written.ptr, number);
    return number;
}

Json to_json(std::span<const OptionField> fields) {
    Json out = Json::object();
    for (const OptionField& field : fields) {
        out[std::string(field.field.name)] =
            std::visit([](const auto& value) { return make_json(value); }, field.ref);
    }
    return out;
}

void from_json(const Json& object, std::span<const OptionField> fields, const std::string& where) {
    check_keys(object, fields, where);
    for (const OptionField& field : fields) {
        const auto found = find_value(object, field.field.name);
        if (found == object.end()) continue;
        const std::string place = fmt::format("{}: {}", where, field.field.name);
        std::visit(ValueReader(*found, field.field, place), field.ref);
    }
}

void describe_value(Json& entry, const OptionField& field) {
    const Field& f = field.field;
    entry["type"] = type_name(field.ref);
    if (const auto* nested = std::get_if<std::vector<OptionField>>(&field.ref)) {
        entry["fields"] = make_schema(*nested);
        return;
    }
    if (const auto* choice = std::get_if<ChoiceRef>(&field.ref)) entry["choices"] = choice->names;
    if (std::holds_alternative<int*>(field.ref) || std::holds_alternative<float*>(field.ref)) {
        entry["unit"] = name_of_unit(f.unit);
        if (f.low < f.high) {
            entry["low"] = f.low;
            entry["high"] = f.high;
        }
    }
    entry["default"] = std::visit([](const auto& value) { return make_json(value); }, field.ref);
}

Json make_schema(std::span<const OptionField> fields) {
    Json out = Json::array();
    for (const OptionField& field : fields) {
        Json entry{{"name", field.field.name}, {"help", field.field.help}, {"common", field.field.common}};
        describe_value(entry, field);
        out.push_back(std::move(entry));
    }
    return out;
}

}  // namespace coppice
