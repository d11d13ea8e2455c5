#include "coppice/studio/show/blob_store.h"

#include <fmt/format.h>

#include <utility>

namespace coppice {
namespace {

constexpr std::size_t kMaxKeys = 4096;

/// Counts a thread that computes geometry.
class Turn {
  public:
    explicit Turn(std::counting_semaphore<2>& makers) : makers_(makers) { makers_.acquire(); }
    ~Turn() { makers_.release(); }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

  private:
    std::counting_semaphore<2>& makers_;
};

}  // namespace

BlobStore::Entry& BlobStore::put(const std::string& key) {
    entries_.push_back({key, {}, nullptr});
    by_key_[key] = std::prev(entries_.end());
    return entries_.back();
}

void BlobStore::offer(const std::string& key, Make make) {
    const std::scoped_lock lock(mutex_);
    const auto found = by_key_.find(key);
    Entry& entry = found == by_key_.end() ? put(key) : *found->second;
    entry.make = std::move(make);
    forget_old();
}

std::string BlobStore::offer(std::string bytes) {
    const std::scoped_lock lock(mutex_);
    std::string key = fmt::format("made-{}", ++made_);
    bytes_ += bytes.size();
    put(key).bytes = std::make_shared<const std::string>(std::move(bytes));
    forget_old();
    return key;
}

BlobStore::Bytes BlobStore::get(std::string_view key) {
    Make make;
    {
        const std::scoped_lock lock(mutex_);
        const auto found = by_key_.find(key);
        if (found == by_key_.end()) return nullptr;
        entries_.splice(entries_.end(), entries_, found->second);
        if (found->second->bytes) return found->second->bytes;
        make = found->second->make;
    }
    // Two simultaneous requests both compute it, with the same result.
    std::optional<std::string> made = [&] {
        const Turn turn(makers_);
        return make();
    }();
    const std::scoped_lock lock(mutex_);
    const auto found = by_key_.find(key);
    if (!made) {
        if (found != by_key_.end()) forget(found->second);
        return nullptr;
    }
    auto bytes = std::make_shared<const std::string>(std::move(*made));
    if (found == by_key_.end() || found->second->bytes) return bytes;
    found->second->bytes = bytes;
    bytes_ += bytes->size();
    forget_old();
    return bytes;
}

/// The newest one is always stored, regardless of its size.
void BlobStore::forget_old() {
    while (entries_.size() > 1 && (bytes_ > max_bytes_ || entries_.size() > kMaxKeys))
        forget(entries_.begin());
}

void BlobStore::forget(Entries::iterator entry) {
    if (entry->bytes) bytes_ -= entry->bytes->size();
    by_key_.erase(entry->key);
    entries_.erase(entry);
}

}  // namespace coppice
