#pragma once

#include <string>
#include <string_view>

namespace coppice::system_internal {

/// Returns why a name may not be used within a sandbox, to be used at the end of a sentence; empty if the
/// name is valid.
std::string_view fault_of_name(std::string_view name);

/// Opens a path relative to a folder without following symbolic links: returns a descriptor, or -1 with errno
/// (ELOOP for a link). `name` must be valid. open_stepwise opens component by component, for systems without
/// openat2.
int open_beneath(int folder, const std::string& name, int flags);
int open_stepwise(int folder, const std::string& name, int flags);

}  // namespace coppice::system_internal
