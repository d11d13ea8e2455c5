#include "machine.h"

#include <fmt/format.h>
#include <malloc.h>
#include <sys/utsname.h>

#include <fstream>
#include <thread>

#include "coppice/system/process.h"

namespace coppice::bench {
namespace {

// Returns the text after "key:" in a file of such lines.
std::string read_value(const char* file, const std::string& key) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with(key)) continue;
        const std::size_t colon = line.find(':');
        const std::size_t start =
            colon == std::string::npos ? colon : line.find_first_not_of(" \t", colon + 1);
        if (start != std::string::npos) return line.substr(start);
    }
    return {};
}

std::string compiler() {
#if defined(__clang__)
    return fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
    return fmt::format("GCC {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
}

}  // namespace

std::string machine_description() {
    utsname system{};
    uname(&system);
    std::string processor = read_value("/proc/cpuinfo", "model name");
    if (processor.empty()) processor = system.machine;
    return fmt::format("{}, {} cores, {} {}, {}", processor, std::thread::hardware_concurrency(),
                       system.sysname, system.release, compiler());
}

std::size_t resident_bytes() { return measure_memory().resident; }

std::size_t peak_resident_bytes() { return measure_memory().peak; }

void reset_peak() {
    malloc_trim(0);
    // Documented in proc(5). If it is forbidden, the old peak remains, and results are too large, never too
    // small.
    std::ofstream("/proc/self/clear_refs") << "5";
}

}  // namespace coppice::bench
