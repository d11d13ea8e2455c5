#include "coppice/studio/show/blob_store.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "coppice/base/error.h"

namespace coppice {
namespace {

TEST(BlobStore, ComputesARequestedBlobOnce) {
    BlobStore blobs;
    int made = 0;
    blobs.offer("a", [] { return std::string("of a former source"); });
    blobs.offer("a", [&] { return std::to_string(++made); });
    EXPECT_EQ(made, 0);
    EXPECT_EQ(*blobs.get("a"), "1");
    blobs.offer("a", [] { return std::string("another"); });
    EXPECT_EQ(*blobs.get("a"), "1");
    EXPECT_EQ(blobs.get("b"), nullptr);
}

TEST(BlobStore, EvictsTheOldestAndStoresTheNewestOfAnySize) {
    BlobStore blobs(100);
    const std::string a = blobs.offer(std::string(60, 'a'));
    const std::string b = blobs.offer(std::string(30, 'b'));
    EXPECT_NE(blobs.get(a), nullptr);  // used after b
    const std::string c = blobs.offer(std::string(30, 'c'));
    EXPECT_EQ(blobs.get(b), nullptr);
    EXPECT_NE(blobs.get(a), nullptr);
    const std::string large = blobs.offer(std::string(1000, 'x'));
    EXPECT_EQ(blobs.get(large)->size(), 1000u);
    EXPECT_EQ(blobs.get(a), nullptr);
}

TEST(BlobStore, RepeatsAFailedComputation) {
    BlobStore blobs;
    bool works = false;
    blobs.offer("a", [&]() -> std::string {
        if (!works) throw InvalidInput("not yet");
        return "made";
    });
    EXPECT_THROW(blobs.get("a"), InvalidInput);
    works = true;
    EXPECT_EQ(*blobs.get("a"), "made");
}

TEST(BlobStore, DiscardsBlobsWithoutAResult) {
    BlobStore blobs;
    const std::size_t requested = 2;
    std::size_t times = 0;
    blobs.offer("a", [&]() -> std::optional<std::string> {
        ++times;
        return std::nullopt;
    });
    for (std::size_t i = 0; i < requested; ++i) EXPECT_EQ(blobs.get("a"), nullptr);
    EXPECT_EQ(times, 1u);
}

TEST(BlobStore, ComputesTwoBlobsConcurrently) {
    BlobStore blobs;
    std::atomic<int> now = 0, most = 0;
    std::vector<std::jthread> clients;
    for (int i = 0; i < 6; ++i) {
        const std::string key = std::to_string(i);
        blobs.offer(key, [&] {
            int seen = ++now, before = most;
            while (before < seen && !most.compare_exchange_weak(before, seen)) {
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            --now;
            return std::string("made");
        });
        clients.emplace_back([&blobs, key] { EXPECT_EQ(*blobs.get(key), "made"); });
    }
    clients.clear();
    EXPECT_EQ(most, 2);
}

}  // namespace
}  // namespace coppice
