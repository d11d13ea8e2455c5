#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "coppice/base/fields.h"
#include "coppice/base/vec.h"

namespace coppice {

/// A struct that is listed by `list_fields`; its members may be such structs.
template <class T>
concept OptionStruct = requires(T& options, FieldList& list) {
    list_fields(options, list);
};

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

/// Returns the members of an option struct in the order in which they are listed.
template <OptionStruct Options>
std::vector<OptionField> option_fields(Options& options);

/// Collects the members of an option struct.
class FieldList {
  public:
    /// Adds a member: a bool, int, float, NamedEnum, std::optional<Vec3d>, std::vector<std::string>, or an
    /// option struct; the field then contains its members.
    template <class T>
    void add(const Field& field, T& member) {
        if constexpr (OptionStruct<T>) {
            fields_.push_back({field, option_fields(member)});
        } else if constexpr (NamedEnum<T>) {
            fields_.push_back({field, choice_of(member)});
        } else {
            fields_.push_back({field, &member});
        }
    }

    std::vector<OptionField> take() { return std::move(fields_); }  ///< the members; empties the list

  private:
    std::vector<OptionField> fields_;
};

template <OptionStruct Options>
std::vector<OptionField> option_fields(Options& options) {
    FieldList list;
    list_fields(options, list);
    return list.take();
}

}  // namespace coppice
