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

/// Geometry that clients may fetch by a key: what was made lately, and what is made when it is asked for. All
/// functions may be called from any thread.
class BlobStore {
  public:
    using Bytes = std::shared_ptr<const std::string>;  ///< shared by all who fetch it
    /// Makes it, or nothing where what it was to be made of is gone; may throw an Error.
    using Make = std::function<std::optional<std::string>()>;

    /// Keeps up to so many bytes of what was made, and 4096 keys; the oldest go first. Beside them at most
    /// two are made at a time.
    explicit BlobStore(std::uint64_t most_bytes = std::uint64_t{256} << 20) : most_bytes_(most_bytes) {}

    /// Offers what is made on the thread that asks for it first. Nothing changes where the key is known.
    void offer(const std::string& key, Make make);
    /// Offers what is there already, under a new key.
    std::string offer(std::string bytes);
    /// Nullptr where there is none any more. Throws what making it throws.
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

    std::uint64_t most_bytes_;
    std::counting_semaphore<2> makers_{2};
    std::mutex mutex_;
    Entries entries_;  ///< the newest last
    std::map<std::string, Entries::iterator, std::less<>> by_key_;
    std::uint64_t bytes_ = 0, made_ = 0;
};

}  // namespace coppice
