#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

#include "coppice/studio/growth_relay_internal.h"
#include "coppice/studio/show/geometry_internal.h"

namespace coppice::studio_internal {
namespace {

constexpr std::chrono::milliseconds kApart{100};
constexpr int kShare = 50;        // at most 1/kShare of the time is spent
constexpr std::size_t kHeld = 2;  // skeletons: the newest, and the previous one while it is being encoded
constexpr std::uint64_t kBytesOfNode = 64;  // including the memory to create a skeleton

}  // namespace

/// The current result of a growth. Late readers receive the newest one.
struct GrowthRelay::Newest {
    std::mutex mutex;
    ObjectPtr object;
    std::uint64_t version = 0;
};

void GrowthRelay::runs(std::optional<std::size_t> statement) {
    if (statement) {
        last_.reset();
        newest_ = std::make_shared<Newest>();
    }
    statement_ = statement;
    next_ = Clock::now() + kApart;
}

void GrowthRelay::take(const GrowthSoFar& so_far) {
    if (!statement_) return;
    last_ = StudioGrown{.statement = *statement_,
                        .nodes = so_far.nodes,
                        .until = fmt::format("{}={}", so_far.limit, so_far.rounds),
                        .key = {}};
    const auto start = Clock::now();
    if (!tell_ || start < next_ || so_far.nodes * kBytesOfNode > max_bytes_ / kHeld) return;
    last_->key = offer(so_far.skeleton());
    tell_(*last_);
    const auto end = Clock::now();
    next_ = end + std::max<Clock::duration>(kApart, kShare * (end - start));
}

std::string GrowthRelay::offer(Skeleton skeleton) {
    {
        const std::scoped_lock lock(newest_->mutex);
        newest_->object = std::make_shared<const SceneObject>(SceneObject{std::move(skeleton), 0});
        newest_->version = ++count_;
    }
    std::string key = fmt::format("grown-{}", count_);
    blobs_.offer(key, [growth = std::weak_ptr(newest_)]() -> std::optional<std::string> {
        const std::shared_ptr<Newest> newest = growth.lock();
        if (!newest) return std::string();  // another growth has started; late requests are not an error
        std::unique_lock lock(newest->mutex);
        const ObjectPtr object = newest->object;
        const GeometryHead head{ObjectKind::skeleton, {}, newest->version, {}};
        lock.unlock();
        return encode_object(*object, head, 1, StudioColor::plain, {});
    });
    return key;
}

}  // namespace coppice::studio_internal
