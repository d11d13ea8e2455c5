#pragma once

#include <string>
#include <string_view>

namespace coppice::io_internal {

/// Why a name may not be used within a jail, as the end of a sentence; empty where it may.
std::string_view fault_of_name(std::string_view name);

/// Opens what lies beneath a folder, without following any symbolic link: a descriptor, or -1 with errno
/// (ELOOP for a link). `name` has no fault. The second goes step by step, for systems that lack openat2.
int open_beneath(int folder, const std::string& name, int flags);
int open_stepwise(int folder, const std::string& name, int flags);

}  // namespace coppice::io_internal
