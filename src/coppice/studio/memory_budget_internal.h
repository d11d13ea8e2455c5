#pragma once

#include <algorithm>
#include <cstdint>

namespace coppice {

/// The distribution of the memory of a studio. Two scenes exist at a time: the displayed one, and the one
/// that is being computed.
struct MemoryBudget {
    /// Distributes `max_memory` MiB.
    explicit MemoryBudget(int max_memory)
        : total(static_cast<std::uint64_t>(std::max(max_memory, 1)) << 20),
          scene(total * 20 / 64),
          states(total * 6 / 64),
          surfaces(total * 4 / 64),
          blobs(total * 8 / 64),
          texts(total * 4 / 64),
          growth(total / 64),
          messages(total / 64) {}

    std::uint64_t total;     ///< [bytes] of everything
    std::uint64_t scene;     ///< for the objects of one scene, and temporary results of a request
    std::uint64_t states;    ///< for stored scenes, where undo and changes start
    std::uint64_t surfaces;  ///< for surfaces that follow edits
    std::uint64_t blobs;     ///< for geometry that clients fetch
    std::uint64_t texts;     ///< for the document and undo
    std::uint64_t growth;    ///< for published results of growth
    std::uint64_t messages;  ///< for queued messages and stored answers
};

}  // namespace coppice
