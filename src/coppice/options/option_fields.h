#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "coppice/base/option_struct.h"
#include "coppice/base/vec.h"

namespace coppice {

/// Type-erased access to an enum by the names of its values.
struct ChoiceRef {
    std::span<const std::string_view> names;         ///< names of all values, from 0
    void* value;                                     ///< address of the enum
    std::size_t (*index_of)(const void* value);      ///< reads the index
    void (*assign)(void* value, std::size_t index);  ///< sets the index

    std::size_t index() const { return index_of(value); }        ///< index of the current value
    std::string_view name() const { return names[index()]; }     ///< name of the current value
    void set(std::size_t index) const { assign(value, index); }  ///< requires index < names.size()
};

/// Returns a reference to an enum, which has to outlive the result.
template <NamedEnum E>
ChoiceRef choice_of(E& value) {
    return {EnumNames<E>::names, &value,
            [](const void* at) { return static_cast<std::size_t>(*static_cast<const E*>(at)); },
            [](void* at, std::size_t index) { *static_cast<E*>(at) = static_cast<E>(index); }};
}

struct OptionField;

/// Storage of a member of an option struct; for a nested struct, its members.
using OptionRef = std::variant<bool*, int*, float*, ChoiceRef, std::optional<Vec3d>*,
                               std::vector<std::string>*, std::vector<OptionField>>;

/// One member of an option struct without its type, so that command line, JSON and schema need no templates.
/// It refers to the struct.
struct OptionField {
    Field field;    ///< properties of the member for front ends
    OptionRef ref;  ///< storage of the member
};

/// Returns the members of an option struct in the order in which it visits them.
template <OptionStruct Options>
std::vector<OptionField> option_fields(Options& options) {
    std::vector<OptionField> out;
    visit_fields(options, [&](const Field& field, auto& value) {
        using T = std::remove_cvref_t<decltype(value)>;
        if constexpr (OptionStruct<T>) {
            out.push_back({field, option_fields(value)});
        } else if constexpr (NamedEnum<T>) {
            out.push_back({field, choice_of(value)});
        } else {
            out.push_back({field, &value});
        }
    });
    return out;
}

}  // namespace coppice
