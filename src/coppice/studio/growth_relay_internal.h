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

/// Publishes intermediate results of a growth as blobs with little delay to it: at most ten times a second,
/// and in at most a fiftieth of the time. For one thread; the blobs are encoded by the readers, and are empty
/// after the next growth has started.
class GrowthRelay {
  public:
    using Tell = std::function<void(const StudioGrown&)>;  ///< called when there is a new result

    /// `max_bytes` limits the memory of published results.
    GrowthRelay(BlobStore& blobs, std::uint64_t max_bytes) : blobs_(blobs), max_bytes_(max_bytes) {}

    void tell(Tell tell) { tell_ = std::move(tell); }  ///< sets the callback
    void begin_request() { last_.reset(); }            ///< forgets earlier growth
    void runs(
        std::optional<std::size_t> statement);  ///< the running statement; nullopt: nothing is published
    void take(const GrowthSoFar& so_far);       ///< result of the running statement
    const std::optional<StudioGrown>& last() const { return last_; }  ///< the last result within this request

  private:
    struct Newest;

    std::string offer(Skeleton skeleton);

    using Clock = std::chrono::steady_clock;

    BlobStore& blobs_;
    std::uint64_t max_bytes_;
    Tell tell_;
    std::optional<std::size_t> statement_;
    std::optional<StudioGrown> last_;
    Clock::time_point next_;  ///< time of the next publication
    std::shared_ptr<Newest> newest_ = nullptr;
    std::uint64_t count_ = 0;
};

}  // namespace coppice::studio_internal
