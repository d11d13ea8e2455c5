#pragma once

#include <cstdint>

#include "coppice/base/context.h"

namespace coppice {

/// How far a reader or writer has come: polls the stop of a context and reports progress now and then. Cheap
/// enough to be told of every line and every point.
class FileProgress {
  public:
    /// Of `size` bytes, rows or whatever is counted; 0 = unknown, and then nothing is reported.
    FileProgress(Context ctx, std::uint64_t size);

    /// Throws `Cancelled` when a stop was asked for.
    void at(std::uint64_t done) {
        if (done >= next_) poll(done);
    }

  private:
    void poll(std::uint64_t done);

    Context ctx_;
    std::uint64_t size_;
    std::uint64_t next_ = 0;
};

}  // namespace coppice
