#pragma once

#include <cstddef>
#include <string>

namespace coppice::bench {

/// What the figures depend on besides the program: "AMD EPYC, 2 cores, Linux 6.1.0, GCC 12.2.0".
std::string machine_description();

/// Memory of this process that the system has backed, in bytes; 0 where the system does not say.
std::size_t resident_bytes();

/// The greatest value of `resident_bytes` since the last `reset_peak`.
std::size_t peak_resident_bytes();

/// Gives freed memory back to the system and starts a new peak.
void reset_peak();

}  // namespace coppice::bench
