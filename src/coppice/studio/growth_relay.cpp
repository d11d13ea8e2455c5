#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "coppice/studio/growth_relay_internal.h"
#include "coppice/studio/show/geometry.h"

namespace coppice::studio_internal {
namespace {

constexpr std::chrono::milliseconds kApart{100};
constexpr int kShare = 50;                  // one part of so many of the time is taken
constexpr std::size_t kHanded = 2;          // skeletons that may be fetched
constexpr std::uint64_t kBytesOfNode = 64;  // with what making a skeleton takes

}  // namespace

void GrowthRelay::runs(std::optional<std::size_t> statement) {
    if (statement) last_.reset();
    statement_ = statement;
    handed_.clear();
    next_ = Clock::now() + kApart;
}

void GrowthRelay::take(const GrowthSoFar& so_far) {
    if (!statement_) return;
    last_ = StudioGrown{.statement = *statement_,
                        .nodes = so_far.nodes,
                        .until = fmt::format("{}={}", so_far.limit, so_far.rounds),
                        .key = {}};
    const auto start = Clock::now();
    if (!tell_ || start < next_ || so_far.nodes * kBytesOfNode > most_bytes_ / kHanded) return;
    last_->key = offer(so_far.skeleton());
    tell_(*last_);
    const auto end = Clock::now();
    next_ = end + std::max<Clock::duration>(kApart, kShare * (end - start));
}

std::string GrowthRelay::offer(Skeleton skeleton) {
    handed_.push_back(std::make_shared<const SceneObject>(SceneObject{std::move(skeleton), 0}));
    if (handed_.size() > kHanded) handed_.pop_front();
    const GeometryHead head{ObjectKind::skeleton, {}, ++count_, {}};
    std::string key = fmt::format("grown-{}", count_);
    blobs_.offer(key, [object = std::weak_ptr(handed_.back()), head]() -> std::optional<std::string> {
        const ObjectPtr grown = object.lock();
        if (!grown) return std::nullopt;
        return encode_object(*grown, head, 1, StudioColor::plain, {});
    });
    return key;
}

}  // namespace coppice::studio_internal
