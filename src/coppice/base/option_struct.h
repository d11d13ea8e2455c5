#pragma once

#include "coppice/base/fields.h"

namespace coppice {

/// A struct that describes itself by `visit_fields`; its members may be such structs.
template <class T>
concept OptionStruct = requires(const T& options) {
    visit_fields(options, [](const Field&, const auto&) {});
};

}  // namespace coppice
