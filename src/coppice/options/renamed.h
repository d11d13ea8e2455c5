#pragma once

#include <string_view>

namespace coppice {

/// Returns the present name of an option that was renamed in this version, or an empty view for any other
/// name. Names are those of fields, as `min_diameter`. The command line, scenes and JSON accept former names
/// for one version.
std::string_view present_name(std::string_view former);

}  // namespace coppice
