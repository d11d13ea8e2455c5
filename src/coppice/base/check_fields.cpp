#include "coppice/base/check_fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <type_traits>

#include "coppice/base/error.h"

namespace coppice {
namespace {

void check_choice(const ChoiceRef& choice, std::string_view source, const std::string& name) {
    if (choice.index() < choice.names.size()) return;
    throw InvalidInput(fmt::format("{}: {} must be one of {}", source, name, fmt::join(choice.names, ", ")));
}

template <class Number>
void check_range(const Field& field, Number value, std::string_view source, const std::string& name) {
    const auto low = static_cast<Number>(field.low), high = static_cast<Number>(field.high);
    if (field.low >= field.high || (value >= low && value <= high)) return;
    throw InvalidInput(
        fmt::format("{}: {} must be between {} and {}, but is {}", source, name, low, high, value));
}

}  // namespace

void check_fields(std::span<const OptionField> fields, std::string_view source, const std::string& path) {
    for (const OptionField& member : fields) {
        const std::string name = path + std::string(member.field.name);
        std::visit(
            [&]<class Ref>(const Ref& ref) {
                if constexpr (std::is_same_v<Ref, std::vector<OptionField>>) {
                    check_fields(ref, source, name + ".");
                } else if constexpr (std::is_same_v<Ref, ChoiceRef>) {
                    check_choice(ref, source, name);
                } else if constexpr (std::is_same_v<Ref, int*> || std::is_same_v<Ref, float*>) {
                    check_range(member.field, *ref, source, name);
                }
            },
            member.ref);
    }
}

}  // namespace coppice
