#pragma once

#include <span>
#include <string>
#include <string_view>

#include "coppice/base/option_fields.h"

namespace coppice {

/// Throws InvalidInput for the first field, or field of a nested struct, that is out of its range, NaN, or an
/// undefined value of its enum. `source` names the owner of the options: "render: samples must be between 1
/// and 4096, but is 0", "mesh: project.damping must ...". `path` precedes the names of the fields.
void check_fields(std::span<const OptionField> fields, std::string_view source, const std::string& path = {});

/// The same for the members of an option struct.
template <OptionStruct Options>
void check_fields(const Options& options, std::string_view source) {
    Options checked = options;
    check_fields(option_fields(checked), source);
}

}  // namespace coppice
