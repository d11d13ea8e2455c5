#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "coppice/growth/watch.h"
#include "coppice/scene/object.h"
#include "coppice/studio/session.h"
#include "coppice/studio/show/blob_store.h"

namespace coppice::studio_internal {

/// Hands out what growth has so far as blobs, without holding it up: at most ten times a second, and in at
/// most a fiftieth of the time. One thread's; the blobs are encoded by those who fetch them, and are
/// empty once the next growth has begun.
class GrowthRelay {
  public:
    using Tell = std::function<void(const StudioGrown&)>;  ///< told that there is more

    /// What is handed out takes up to so many bytes.
    GrowthRelay(BlobStore& blobs, std::uint64_t most_bytes) : blobs_(blobs), most_bytes_(most_bytes) {}

    void tell(Tell tell) { tell_ = std::move(tell); }  ///< from now on
    void begin_request() { last_.reset(); }            ///< what has grown before is no matter any more
    void runs(std::optional<std::size_t> statement);   ///< from now on; none: nothing is handed out any more
    void take(const GrowthSoFar& so_far);              ///< of the statement that runs
    const std::optional<StudioGrown>& last() const { return last_; }  ///< how far growth came in this request

  private:
    struct Newest;

    std::string offer(Skeleton skeleton);

    using Clock = std::chrono::steady_clock;

    BlobStore& blobs_;
    std::uint64_t most_bytes_;
    Tell tell_;
    std::optional<std::size_t> statement_;
    std::optional<StudioGrown> last_;
    Clock::time_point next_;  ///< nothing is handed out before
    std::shared_ptr<Newest> newest_ = nullptr;
    std::uint64_t count_ = 0;
};

}  // namespace coppice::studio_internal
