#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "coppice/base/context.h"

namespace coppice {

/// Seconds per stage, and the progress through the stages.
class Stages {
  public:
    Stages(const Context& ctx, std::vector<std::pair<std::string, double>>& seconds)
        : ctx_(ctx), seconds_(seconds) {}

    template <class Work>
    auto run(const char* name, float progress_after, const Work& work) {
        ctx_.throw_if_cancelled();
        const auto start = std::chrono::steady_clock::now();
        auto result = work();
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        seconds_.emplace_back(name, took.count());
        ctx_.report(progress_after);
        return result;
    }

    /// The same stages under another context, which has to outlive the result.
    Stages with(const Context& ctx) const { return {ctx, seconds_}; }

  private:
    const Context& ctx_;
    std::vector<std::pair<std::string, double>>& seconds_;
};

}  // namespace coppice
