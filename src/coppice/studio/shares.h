#pragma once

#include <algorithm>
#include <cstdint>

namespace coppice {

/// How a studio shares out the memory that it may take. There are two scenes at a time: the one that is
/// shown, and the one that is being made.
struct StudioShares {
    /// Of so many MiB in all.
    explicit StudioShares(int max_memory)
        : total(static_cast<std::uint64_t>(std::max(max_memory, 1)) << 20),
          scene(total * 20 / 64),
          states(total * 6 / 64),
          surfaces(total * 4 / 64),
          blobs(total * 8 / 64),
          texts(total * 4 / 64),
          growth(total / 64),
          messages(total / 64) {}

    std::uint64_t total;     ///< [bytes] of everything
    std::uint64_t scene;     ///< of the objects of one scene, and of what a request makes beside it
    std::uint64_t states;    ///< of scenes that undo and changes begin with
    std::uint64_t surfaces;  ///< of those that follow edits
    std::uint64_t blobs;     ///< of geometry that clients fetch
    std::uint64_t texts;     ///< of the document and what undo takes back
    std::uint64_t growth;    ///< of what grows while it is looked at
    std::uint64_t messages;  ///< that wait, and of answers that are kept
};

}  // namespace coppice
