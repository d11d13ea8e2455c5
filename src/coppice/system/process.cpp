#include "coppice/system/process.h"

#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>

namespace coppice {

ProcessMemory measure_memory() {
    ProcessMemory out;
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        const auto read = [&](std::string_view key, std::uint64_t& bytes) {
            if (line.starts_with(key)) bytes = 1024 * std::strtoull(line.c_str() + key.size(), nullptr, 10);
        };
        read("VmRSS:", out.resident);
        read("VmHWM:", out.peak);
        read("VmData:", out.data);
    }
    return out;
}

int get_process_id() { return ::getpid(); }

bool has_shared_library(const char* name) {
    void* const library = ::dlopen(name, RTLD_LAZY | RTLD_LOCAL);
    if (library != nullptr) ::dlclose(library);
    return library != nullptr;
}

}  // namespace coppice
