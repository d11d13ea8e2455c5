#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/io/text.h"
#include "coppice/sketch/view.h"

namespace coppice::io_internal {

/// Its objects are sorted by the names of their members.
using SortedJson = nlohmann::json;

/// A value of a file with its path for messages: "tree.sketch.json: branches[3].strokes.front".
class Value {
  public:
    Value(const SortedJson& json, std::string where) : json_(json), where_(std::move(where)) {}

    [[noreturn]] void fail(const std::string& subject) const { throw InvalidInput(where_ + " " + subject); }

    /// Throws unless the value is an object with members of these names only.
    void expect_members(std::initializer_list<std::string_view> names) const {
        if (!json_.is_object()) fail("must be an object with named fields");
        for (const auto& [key, value] : json_.items()) {
            if (std::ranges::find(names, key) == names.end())
                fail(fmt::format("has no field {}; there are {}", in_quotes(key), fmt::join(names, ", ")));
        }
    }
    bool has(const std::string& name) const { return json_.contains(name); }
    Value member(const std::string& name) const {
        const auto found = json_.find(name);
        if (found == json_.end()) throw InvalidInput(field(name) + " is missing");
        return {*found, field(name)};
    }
    std::vector<std::pair<std::string, Value>> members() const {
        if (!json_.is_object()) fail("must be an object with named fields");
        std::vector<std::pair<std::string, Value>> out;
        for (const auto& [key, value] : json_.items()) out.emplace_back(key, Value(value, field(key)));
        return out;
    }
    std::vector<Value> items() const {
        if (!json_.is_array()) fail("must be a list");
        std::vector<Value> out;
        for (std::size_t i = 0; i < json_.size(); ++i)
            out.emplace_back(json_[i], fmt::format("{}[{}]", where_, i));
        return out;
    }
    std::string text() const {
        if (!json_.is_string()) fail("must be a text");
        return json_.get<std::string>();
    }
    double number() const {
        if (!json_.is_number()) fail("must be a number");
        return json_.get<double>();
    }
    bool truth() const {
        if (!json_.is_boolean()) fail("must be true or false");
        return json_.get<bool>();
    }
    int pixels() const {
        const double n = number();
        if (!(n >= 1 && n <= 1e6) || n != std::floor(n)) fail("must be a whole number of pixels");
        return static_cast<int>(n);
    }
    std::vector<double> numbers() const {
        if (!json_.is_array()) fail("must be a list of numbers");
        std::vector<double> out;
        for (const SortedJson& number : json_) {
            if (!number.is_number()) fail("must be a list of numbers");
            out.push_back(number.get<double>());
        }
        return out;
    }
    template <std::size_t N>
    std::array<double, N> get_numbers() const {
        const std::vector<double> list = numbers();
        if (list.size() != N) fail(fmt::format("must be a list of {} numbers, not {}", N, list.size()));
        std::array<double, N> out;
        std::ranges::copy(list, out.begin());
        return out;
    }
    Matrix3 matrix() const {
        const std::vector<Value> rows = items();
        if (rows.size() != 3) fail("must be three rows of three numbers");
        return {rows[0].get_numbers<3>(), rows[1].get_numbers<3>(), rows[2].get_numbers<3>()};
    }
    template <class Choice>
    Choice choice(std::initializer_list<std::pair<std::string_view, Choice>> choices) const {
        const std::string word = text();
        std::string known;
        for (const auto& [name, value] : choices) {
            if (name == word) return value;
            known += (known.empty() ? "" : ", ") + std::string(name);
        }
        fail("must be one of " + known);
    }

  private:
    std::string field(const std::string& name) const {
        return where_ + (where_.ends_with(": ") ? "" : where_.ends_with(":") ? " " : ".") + name;
    }

    const SortedJson& json_;
    std::string where_;
};

/// Parses a text. Throws InvalidInput with the line.
inline SortedJson parse_json(std::string_view text, const std::string& source) {
    try {
        return SortedJson::parse(text);
    } catch (const SortedJson::parse_error& error) {
        const std::string_view before = text.substr(0, std::min(error.byte, text.size()));
        fail_at(source, static_cast<std::size_t>(std::ranges::count(before, '\n')) + 1,
                "this is not valid JSON");
    } catch (const SortedJson::exception&) {
        throw InvalidInput(source + ": this is not valid JSON");
    }
}

}  // namespace coppice::io_internal
