#include "coppice/base/progress.h"

#include <gtest/gtest.h>

#include <vector>

namespace coppice {
namespace {

TEST(Progress, PartReportsWithinItsRange) {
    std::vector<float> reported;
    const Context whole{.progress = [&](float f) { reported.push_back(f); }};
    const Context half = narrow_progress(whole, 0.5f, 1), last = narrow_progress(half, 0.5f, 1);
    half.report(0);
    half.report(0.5f);
    last.report(0.5f);
    last.report(1);
    EXPECT_EQ(reported, (std::vector<float>{0.5f, 0.75f, 0.875f, 1}));
    narrow_progress({}, 0, 1).report(0.5f);  // no callback
}

TEST(Progress, CheckInReportsOrThrows) {
    std::stop_source source;
    std::vector<float> reported;
    const Context ctx{.stop = source.get_token(), .progress = [&](float f) { reported.push_back(f); }};
    check_in(ctx, 1, 4);
    check_in(ctx, 0, 0);
    source.request_stop();
    EXPECT_THROW(check_in(ctx, 2, 4), Cancelled);
    EXPECT_THROW(narrow_progress(ctx, 0, 1).throw_if_cancelled(), Cancelled);
    EXPECT_EQ(reported, (std::vector<float>{0.25f}));
}

TEST(Progress, LoopHasTheRangesOfParallelForAndReportsSteps) {
    const auto compute_ranges = [](const Context& ctx) {
        std::vector<std::size_t> end(100'003, 0);
        parallel_with_progress(ctx, end.size(), 7, [&](IndexRange r) {
            for (std::size_t i = r.begin; i < r.end; ++i) end[i] = r.end;
        });
        return end;
    };
    std::vector<float> reported;
    const Context ctx{.threads = 2, .progress = [&](float f) { reported.push_back(f); }};
    EXPECT_EQ(compute_ranges(ctx), compute_ranges({.threads = 2}));
    ASSERT_EQ(reported.size(), 100u);
    for (std::size_t i = 0; i < reported.size(); ++i)
        EXPECT_NEAR(reported[i], 0.01 * static_cast<double>(i + 1), 0.006);
}

}  // namespace
}  // namespace coppice
