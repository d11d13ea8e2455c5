#pragma once

#include <cstdint>

#include "coppice/base/context.h"

namespace coppice {

/// Polls the cancellation of a context and reports the progress of a reader or writer at intervals. Cheap
/// enough to be called for every line and every point.
class FileProgress {
  public:
    /// `size` is the total in any unit, such as bytes or rows; with 0 (unknown) no progress is reported.
    FileProgress(Context ctx, std::uint64_t size);

    /// Throws `Cancelled` on cancellation.
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
