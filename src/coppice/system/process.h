#pragma once

#include <cstdint>

namespace coppice {

/// Memory of this process [bytes]; 0 where the system does not report it.
struct ProcessMemory {
    std::uint64_t resident = 0;  ///< pages that are in memory
    std::uint64_t peak = 0;      ///< maximum of `resident`
    std::uint64_t data = 0;      ///< reserved for data, which RLIMIT_DATA limits
};

/// Measures the memory of this process.
ProcessMemory measure_memory();

/// Returns the number of this process, which no other running process of the machine has.
int get_process_id();

/// Returns whether the dynamic loader finds a shared library, for example "libEGL.so.1".
bool has_shared_library(const char* name);

}  // namespace coppice
