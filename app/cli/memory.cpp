#include "memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <new>

#include "coppice/system/process.h"

namespace coppice::cli {
namespace {

constexpr std::uint64_t kMebi = std::uint64_t{1} << 20;
constexpr std::uint64_t kStack = 4 * kMebi;     // stack of a oneTBB thread
constexpr std::uint64_t kProgram = 16 * kMebi;  // code and tables that are read from disk on first use
constexpr std::uint64_t kReserve = 8 * kMebi;   // memory for an orderly exit

std::atomic<std::uint64_t> max_data = 0;  // [bytes] 0 = no limit
std::array<char, 128> text{"there is not enough memory for this input with these options"};

void allow_data(std::uint64_t bytes) {
    rlimit limit{};
    if (getrlimit(RLIMIT_DATA, &limit) != 0) return;
    limit.rlim_cur = std::min<rlim_t>(bytes, limit.rlim_max);
    setrlimit(RLIMIT_DATA, &limit);
}

/// Called by operator new when memory is exhausted: releases the reserve, so that the code that handles the
/// exception can allocate.
void on_exhaustion() {
    allow_data(max_data);
    throw std::bad_alloc();
}

}  // namespace

int memory_of_machine() {
    const auto pages = static_cast<std::uint64_t>(std::max(0L, sysconf(_SC_PHYS_PAGES)));
    const auto bytes = pages * static_cast<std::uint64_t>(std::max(0L, sysconf(_SC_PAGESIZE)));
    const std::uint64_t most = std::numeric_limits<int>::max();
    return static_cast<int>(std::clamp<std::uint64_t>(bytes / kMebi, kMinMemory, most));
}

void limit_memory(int mebibytes, unsigned threads) {
    const ProcessMemory now = measure_memory();
    if (now.resident == 0 || now.data == 0) return;
    const std::uint64_t wanted = static_cast<std::uint64_t>(std::max(mebibytes, kMinMemory)) * kMebi;
    const std::uint64_t taken = std::min(wanted - 2 * kReserve, now.resident + kProgram);
    max_data = now.data + threads * kStack + (wanted - taken);
    const auto end =
        fmt::format_to_n(text.begin(), text.size() - 1,
                         "this needs more than the {} MiB of memory that --max-memory allows", mebibytes);
    *end.out = '\0';
    std::set_new_handler(on_exhaustion);
    renew_memory_limit();
}

void renew_memory_limit() {
    if (max_data != 0) allow_data(max_data - kReserve);
}

const char* out_of_memory_text() { return text.data(); }

}  // namespace coppice::cli
