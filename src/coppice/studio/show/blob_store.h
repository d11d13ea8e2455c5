#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <semaphore>
#include <string>
#include <string_view>

namespace coppice {

/// Geometry that clients fetch by a key: stored results, and results that are computed on request. All
/// functions are thread-safe.
class BlobStore {
  public:
    using Bytes = std::shared_ptr<const std::string>;  ///< shared by all readers
    /// Computes the geometry, or returns nullopt if its source no longer exists; may throw an Error.
    using Make = std::function<std::optional<std::string>()>;

    /// Stores at most that many bytes of results, and 4096 keys; removes the oldest first. In addition, at
    /// most two are being computed at a time.
    explicit BlobStore(std::uint64_t max_bytes = std::uint64_t{256} << 20) : max_bytes_(max_bytes) {}

    /// Offers a result that is computed by the first thread that requests it. For a key that exists, it
    /// replaces the computation; a result that is stored remains.
    void offer(const std::string& key, Make make);
    /// Offers an existing result under a new key.
    std::string offer(std::string bytes);
    /// Returns nullptr if the geometry no longer exists. Throws as its computation.
    Bytes get(std::string_view key);

  private:
    struct Entry {
        std::string key;
        Make make;
        Bytes bytes;
    };
    using Entries = std::list<Entry>;

    Entry& put(const std::string& key);
    void forget_old();
    void forget(Entries::iterator entry);

    std::uint64_t max_bytes_;
    std::counting_semaphore<2> makers_{2};
    std::mutex mutex_;
    Entries entries_;  ///< the newest last
    std::map<std::string, Entries::iterator, std::less<>> by_key_;
    std::uint64_t bytes_ = 0, made_ = 0;
};

}  // namespace coppice
