#pragma once

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <string>
#include <vector>

#include "coppice/pipeline/json.h"

namespace coppice::cli {

/// The command line itself is wrong: exit code 2.
class UsageError : public Error {
  public:
    using Error::Error;
};

namespace detail {

std::string flag_name(std::string_view field_name);  ///< wire_width -> --wire-width
double parse_number(const std::string& text, const std::string& flag, const Field& field, bool whole);
std::size_t parse_name(const std::string& text, const std::string& flag,
                       std::span<const std::string_view> names);
std::string number_help(const Field& field, double default_value);

template <class T>
void add_flag(CLI::App& app, const Field& field, T& value, const std::string& flag,
              const std::string& group) {
    CLI::Option* option = nullptr;
    const std::string help(field.help);
    if constexpr (std::is_same_v<T, bool>) {
        // Both are understood, but only the one that changes something is shown.
        const std::string off = "--no-" + flag.substr(2);
        const auto turn_on = [&value](std::int64_t) { value = true; };
        const auto turn_off = [&value](std::int64_t) { value = false; };
        CLI::Option* const on_option = app.add_flag_function(flag, turn_on, help + " [default off]");
        CLI::Option* const off_option =
            app.add_flag_function(off, turn_off, "not: " + help + " [default on]");
        option = value ? off_option : on_option;
        (value ? on_option : off_option)->group("");
    } else if constexpr (NamedEnum<T>) {
        const auto set = [&value, flag](const std::string& text) {
            value = static_cast<T>(parse_name(text, flag, EnumNames<T>::names));
        };
        option = app.add_option_function<std::string>(
            flag, set,
            fmt::format("{} [{}; default {}]", help, fmt::join(EnumNames<T>::names, ", "), name_of(value)));
        option->type_name("NAME");
    } else {
        constexpr bool kWhole = std::is_same_v<T, int>;
        const auto set = [&value, flag, field](const std::string& text) {
            value = static_cast<T>(parse_number(text, flag, field, kWhole));
        };
        double start = static_cast<double>(value);
        if constexpr (!kWhole) start = shortest(value);
        option = app.add_option_function<std::string>(flag, set, help + " " + number_help(field, start));
        option->type_name("NUMBER");
    }
    option->group(group);
}

}  // namespace detail

/// Adds a flag for every field of an options struct; parsing stores into it, so it must live as long. Fields
/// of nested structs are flags too, under a heading of their own; where a name is taken, that of the struct
/// goes before it.
template <OptionStruct Options>
void add_options(CLI::App& app, Options& options, const std::string& group, const std::string& prefix = {}) {
    visit_fields(options, [&](const Field& field, auto& value) {
        using T = std::remove_cvref_t<decltype(value)>;
        if constexpr (OptionStruct<T>) {
            add_options(app, value, std::string(field.help), std::string(field.name));
        } else {
            std::string flag = detail::flag_name(field.name);
            const bool taken = app.get_option_no_throw(flag) != nullptr;
            if (taken) flag = detail::flag_name(fmt::format("{}_{}", prefix, field.name));
            detail::add_flag(app, field, value, flag, group);
        }
    });
}

}  // namespace coppice::cli
