#pragma once

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <numeric>
#include <span>
#include <type_traits>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/device.h"

// Padding between the members of a kernel may contain elements of an address. If the compiler cannot clear it
// (clang 14), kernels are not checked.
#if __has_builtin(__builtin_clear_padding)
#define COPPICE_CLEARS_PADDING
#endif

namespace coppice::cuda {

/// A group of threads that runs in waves, the last thread of each first: see HostGroup.
class StrictGroup {
  public:
    template <class Body>
    COPPICE_HOST_DEVICE void each(std::uint32_t count, const Body& body) const {
        for (std::uint32_t i = count; i-- > 0;) body(i);
    }
    template <class Test>
    COPPICE_HOST_DEVICE std::uint32_t select(std::uint32_t count, const Test& test,
                                             std::uint32_t* out) const {
        std::uint32_t found = 0;
        for (std::uint32_t begin = 0; begin < count; begin += kWave) {
            bool is_one[kWave] = {};
            const std::uint32_t size = std::min(kWave, count - begin);
            for (std::uint32_t i = size; i-- > 0;) is_one[i] = test(begin + i);
            for (std::uint32_t i = 0; i < size; ++i) {
                if (is_one[i]) out[found++] = begin + i;
            }
        }
        return found;
    }

  private:
    static constexpr std::uint32_t kWave = 128;
};

/// Runs kernels on the CPU under the restrictions of a GPU: its memory is separate, initially filled with
/// garbage, and accessible only to kernels and copies, so that the host crashes if it accesses an array that
/// was not copied back; kernels must not refer to arrays of the host; and threads run in another order. See
/// HostExecutor for the members.
class StrictExecutor {
  public:
    static constexpr bool kIsDevice = false;

    class Recording {
      public:
        void clear() {
            launches_.clear();
            times_ = 0;
        }

      private:
        friend StrictExecutor;
        std::vector<std::function<void()>> launches_;
        int times_ = 0;
        std::size_t begin_ = 0, end_ = 0, most_ = 0;
    };

    explicit StrictExecutor(const Context& ctx = {}) : ctx_(ctx) {
        void* const memory =
            mmap(nullptr, kSize, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        if (memory == MAP_FAILED) throw std::bad_alloc();
        begin_ = static_cast<std::byte*>(memory);
    }
    StrictExecutor(const StrictExecutor&) = delete;
    StrictExecutor& operator=(const StrictExecutor&) = delete;
    ~StrictExecutor() { munmap(begin_, kSize); }

    template <class T>
    std::span<T> array(std::size_t count) {
        static_assert(std::is_trivially_copyable_v<T>);
        const std::size_t bytes = (count * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
        if (bytes > kSize - used_) throw std::bad_alloc();
        std::byte* const out = begin_ + used_;
        used_ += bytes;
        greatest_ = std::max(greatest_, used_);
        const Open open(*this);
        std::memset(out, kRubbish, bytes);
        return {reinterpret_cast<T*>(out), count};
    }
    template <class T>
    std::span<const T> upload(std::span<const T> values) {
        const std::span<T> out = array<T>(values.size());
        write(values, out);
        return out;
    }
    template <class T>
    void write(std::span<const T> from, std::span<T> to) {
        expect_there(to);
        EXPECT_EQ(noted_, nullptr) << "a repeated recording copies data";
        const Open open(*this);
        std::copy(from.begin(), from.end(), to.begin());
    }
    template <class T>
    void download(std::span<const T> from, std::span<T> to) {
        expect_there(from);
        EXPECT_EQ(noted_, nullptr) << "a repeated recording waits";
        const Open open(*this);
        std::copy(from.begin(), from.end(), to.begin());
    }
    template <class T>
    std::span<const T> fetch(std::span<const T> from) {
        fetched_.push_back(
            std::make_unique_for_overwrite<std::byte[]>(std::max<std::size_t>(1, from.size_bytes())));
        const std::span<T> to{reinterpret_cast<T*>(fetched_.back().get()), from.size()};
        download(from, to);
        return to;
    }
    template <class T>
    void clear(std::span<T> values) {
        expect_there(values);
        if (noted_ != nullptr) return noted_->push_back([=, this] { clear(values); });
        const Open open(*this);
        std::memset(static_cast<void*>(values.data()), 0, values.size_bytes());
    }
    using Mark = std::size_t;
    Mark mark() const { return used_; }
    void rewind(Mark mark) { used_ = mark; }
    void reset() {
        used_ = 0;
        fetched_.clear();
    }

    template <class Kernel>
    void each(const char* name, std::size_t count, const Kernel& kernel) {
        if (noted_ != nullptr) return noted_->push_back([=, this] { each(name, count, kernel); });
        const Open open(*this, name, kernel);
        for (std::size_t i = count; i-- > 0;) kernel(static_cast<std::uint32_t>(i));
    }
    template <class Kernel>
    void groups(const char* name, std::size_t count, const Kernel& kernel) {
        if (noted_ != nullptr) return noted_->push_back([=, this] { groups(name, count, kernel); });
        const Open open(*this, name, kernel);
        for (std::size_t i = count; i-- > 0;) kernel(static_cast<std::uint32_t>(i), StrictGroup());
    }
    template <class T>
    void exclusive_scan(std::span<const T> counts, std::span<T> out) {
        expect_there(counts);
        expect_there(out);
        if (noted_ != nullptr) return noted_->push_back([=, this] { exclusive_scan(counts, out); });
        const Open open(*this);
        std::exclusive_scan(counts.begin(), counts.end(), out.begin(), T{});
    }
    template <class Key>
    void sort_pairs(std::span<Key> keys, std::span<std::uint32_t> values, int bits = 8 * sizeof(Key)) {
        expect_there(keys);
        expect_there(values);
        if (noted_ != nullptr) return noted_->push_back([=, this] { sort_pairs(keys, values, bits); });
        const Open open(*this);
        std::vector<std::pair<Key, std::uint32_t>> pairs;
        for (std::size_t i = 0; i < keys.size(); ++i) pairs.emplace_back(keys[i], values[i]);
        const Key mask = ~Key{0} >> (8 * sizeof(Key) - static_cast<unsigned>(bits));
        std::ranges::stable_sort(pairs, {}, [&](const auto& p) { return p.first & mask; });
        for (std::size_t i = 0; i < keys.size(); ++i) std::tie(keys[i], values[i]) = pairs[i];
    }
    /// Behaves as a CUDA graph: the second call records the launches before they are executed; later calls
    /// execute the recorded launches, with the arrays and values of that time.
    template <class Work>
    void replay(Recording& recording, const Work& work) {
        const Mark begin = mark();
        if (recording.launches_.empty() || recording.begin_ != begin) {
            if (recording.times_++ != 1) return work();
            note(recording, work);
        }
        used_ = recording.most_;
        for (const auto& launch : recording.launches_) launch();
        used_ = recording.end_;
    }
    void wait() const { EXPECT_EQ(noted_, nullptr) << "a repeated recording waits"; }

    std::size_t room() const { return kSize; }
    void reserve(std::size_t bytes) const { require_room(kSize, bytes); }

    std::size_t bytes_used() const { return greatest_; }  ///< at once, in blocks of the size used on a GPU

  private:
    static constexpr std::size_t kSize = std::size_t{1} << 30, kAlignment = 256;
    static constexpr int kRubbish = 0xa5;
    static constexpr std::size_t kMaxOfKernel = 4000;  // as CudaExecutor

    /// Makes the memory accessible during its lifetime.
    class Open {
      public:
        explicit Open(const StrictExecutor& of) : of_(of) { protect(PROT_READ | PROT_WRITE); }
        template <class Kernel>
        Open(const StrictExecutor& of, [[maybe_unused]] const char* name,
             [[maybe_unused]] const Kernel& kernel)
            : Open(of) {
            static_assert(std::is_trivially_copyable_v<Kernel> && sizeof(Kernel) <= kMaxOfKernel);
            of.ctx_.throw_if_cancelled();
#ifdef COPPICE_CLEARS_PADDING
            Kernel members = kernel;
            __builtin_clear_padding(&members);
            of.expect_nothing_of_host(name, std::as_bytes(std::span(&members, 1)));
#endif
        }
        ~Open() { protect(PROT_NONE); }
        Open(const Open&) = delete;
        Open& operator=(const Open&) = delete;

      private:
        void protect(int how) const {
            const std::size_t bytes = std::max<std::size_t>(of_.used_, 1);
            if (mprotect(of_.begin_, bytes, how) != 0) throw std::bad_alloc();
        }
        const StrictExecutor& of_;
    };

    template <class Work>
    void note(Recording& recording, const Work& work) {
        recording.begin_ = used_;
        const std::size_t before = std::exchange(greatest_, used_);
        noted_ = &recording.launches_;
        work();
        noted_ = nullptr;
        recording.most_ = greatest_;
        recording.end_ = used_;
        greatest_ = std::max(greatest_, before);
    }

    bool is_there(std::uintptr_t address) const {
        return address - reinterpret_cast<std::uintptr_t>(begin_) < kSize;
    }
    template <class T>
    void expect_there(std::span<T> values) const {
        EXPECT_TRUE(values.empty() || is_there(reinterpret_cast<std::uintptr_t>(values.data())));
    }
    /// Reports an apparent span that refers to memory of the host, which a GPU could not read.
    void expect_nothing_of_host(const char* name, std::span<const std::byte> kernel) const {
        struct {
            std::uintptr_t address;
            std::size_t size;
        } span;
        constexpr std::size_t kLongest = kSize / sizeof(float);  // longer ones would not fit
        for (std::size_t at = 0; at + sizeof span <= kernel.size(); at += sizeof(void*)) {
            std::memcpy(&span, kernel.data() + at, sizeof span);
            if (span.size == 0 || span.size > kLongest || is_there(span.address)) continue;
            EXPECT_FALSE(is_mapped(span.address))
                << name << " is given memory of the host, at byte " << at << ": " << std::hex << span.address;
        }
    }
    static bool is_mapped(std::uintptr_t address) {
        const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
        return msync(reinterpret_cast<void*>(address / page * page), page, MS_ASYNC) == 0;
    }

    Context ctx_;
    std::byte* begin_ = nullptr;
    std::vector<std::unique_ptr<std::byte[]>> fetched_;
    std::size_t used_ = 0, greatest_ = 0;
    std::vector<std::function<void()>>* noted_ = nullptr;  // see replay()
};

}  // namespace coppice::cuda
