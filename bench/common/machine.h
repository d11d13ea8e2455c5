#pragma once

#include <cstddef>
#include <string>

namespace coppice::bench {

/// Returns the properties of the machine that affect results: "AMD EPYC, 2 cores, Linux 6.1.0, GCC 12.2.0".
std::string machine_description();

/// Returns the resident memory of this process in bytes; 0 if the system does not report it.
std::size_t resident_bytes();

/// Returns the maximum of `resident_bytes` since the last `reset_peak`.
std::size_t peak_resident_bytes();

/// Returns freed memory to the system and starts a new peak.
void reset_peak();

}  // namespace coppice::bench
