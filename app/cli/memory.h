#pragma once

#include <cstdint>

namespace coppice::cli {

/// [MiB] the memory of this machine; never 0.
int memory_of_machine();

/// [MiB] the program itself needs about half of this before it has read anything.
inline constexpr int kLeastMemory = 64;

/// Holds the resident memory of the process to `mebibytes`, at least kLeastMemory, from here on: the system
/// refuses what goes beyond it, whoever asks (the library, Embree, zlib, a thread), and std::bad_alloc is
/// thrown as if the machine had no more. Data counts as soon as it is set aside, touched or not, so that
/// a refusal may come a little early but never late. `threads` is the number of threads that may still be
/// started, whose stacks are set aside too but hardly touched.
///
/// Where the system cannot do so (other than Linux from 4.7 on), nothing happens.
void limit_memory(int mebibytes, unsigned threads);

/// Gives back the last bit of memory that is kept for ending in order, after a std::bad_alloc that was dealt
/// with.
void renew_memory_limit();

/// One sentence for a std::bad_alloc; allocates nothing.
const char* out_of_memory_text();

}  // namespace coppice::cli
