#pragma once

#include <cstdint>

namespace coppice::cli {

/// [MiB] Returns the memory of this machine; never 0.
int memory_of_machine();

/// [MiB] minimum limit; the program needs about half of this before it reads any input.
inline constexpr int kMinMemory = 64;

/// Limits the resident memory of the process to `mebibytes`, at least kMinMemory, from now on: the system
/// refuses allocations beyond it, whether made by the library, Embree, zlib or a thread, and std::bad_alloc
/// is thrown as if the machine had no more. Memory counts as soon as it is allocated, used or not, so that a
/// refusal can be slightly early but never late. `threads` is the number of threads that may still be
/// started; their stacks are allocated too but hardly used.
///
/// Has no effect on other systems than Linux 4.7 or later.
void limit_memory(int mebibytes, unsigned threads);

/// Restores the memory reserve for an orderly exit after a std::bad_alloc was handled.
void renew_memory_limit();

/// Returns one sentence for a std::bad_alloc; does not allocate.
const char* out_of_memory_text();

}  // namespace coppice::cli
