#pragma once

#include <string>
#include <string_view>

namespace coppice::server {

/// Returns 256 random bits from the system as 43 letters, digits, - and _. Throws IoError if the system
/// provides none.
std::string make_token();

/// Returns whether both are equal, in a time that does not depend on where they differ.
bool same_token(std::string_view given, std::string_view token);

}  // namespace coppice::server
