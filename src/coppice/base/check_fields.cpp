#include "coppice/base/check_fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <type_traits>

#include "coppice/base/error.h"

namespace coppice {
namespace {

/// Throws InvalidInput if the value of a member without members of its own is invalid.
template <class Ref>
void check_member(const Field& field, const Ref& ref, std::string_view source, const std::string& path) {
    if constexpr (std::is_same_v<Ref, ChoiceRef>) {
        if (ref.index() < ref.names.size()) return;
        throw InvalidInput(
            fmt::format("{}: {}{} must be one of {}", source, path, field.name, fmt::join(ref.names, ", ")));
    } else if constexpr (std::is_same_v<Ref, int*> || std::is_same_v<Ref, float*>) {
        using Number = std::remove_pointer_t<Ref>;
        const auto low = static_cast<Number>(field.low), high = static_cast<Number>(field.high);
        if (field.low >= field.high || (*ref >= low && *ref <= high)) return;
        throw InvalidInput(fmt::format("{}: {}{} must be between {} and {}, but is {}", source, path,
                                       field.name, low, high, *ref));
    }
}

}  // namespace

void check_fields(std::span<const OptionField> fields, std::string_view source, const std::string& path) {
    for (const OptionField& member : fields) {
        if (const auto* nested = std::get_if<std::vector<OptionField>>(&member.ref)) {
            check_fields(*nested, source, fmt::format("{}{}.", path, member.field.name));
        } else {
            std::visit([&](const auto& ref) { check_member(member.field, ref, source, path); }, member.ref);
        }
    }
}

}  // namespace coppice
