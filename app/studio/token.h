#pragma once

#include <string>
#include <string_view>

namespace coppice::server {

/// 256 bits from the system, as 43 letters, digits, - and _. Throws IoError where the system has none.
std::string make_token();

/// Whether both are the same, in a time that tells nothing of where they differ.
bool same_token(std::string_view given, std::string_view token);

}  // namespace coppice::server
