#include "coppice/system/file_progress.h"

#include <algorithm>
#include <utility>

namespace coppice {

FileProgress::FileProgress(Context ctx, std::uint64_t size) : ctx_(std::move(ctx)), size_(size) {}

void FileProgress::poll(std::uint64_t done) {
    constexpr std::uint64_t kMaxSteps = 1000, kLongestStep = 65536;
    ctx_.throw_if_cancelled();
    next_ = done + kLongestStep;
    if (size_ == 0) return;
    ctx_.report(static_cast<float>(static_cast<double>(done) / static_cast<double>(size_)));
    next_ = done + std::clamp<std::uint64_t>(size_ / kMaxSteps, 1, kLongestStep);
}

}  // namespace coppice
