#include "coppice/base/progress.h"

#include <gtest/gtest.h>

#include <vector>

namespace coppice {
namespace {

TEST(Progress, APartReportsWithinItsPartOfTheWhole) {
    std::vector<float> told;
    const Context whole{.progress = [&](float f) { told.push_back(f); }};
    const Context half = part_of(whole, 0.5f, 1), last = part_of(half, 0.5f, 1);
    half.report(0);
    half.report(0.5f);
    last.report(0.5f);
    last.report(1);
    EXPECT_EQ(told, (std::vector<float>{0.5f, 0.75f, 0.875f, 1}));
    part_of({}, 0, 1).report(0.5f);  // nobody asked
}

TEST(Progress, ALookTellsOrThrows) {
    std::stop_source source;
    std::vector<float> told;
    const Context ctx{.stop = source.get_token(), .progress = [&](float f) { told.push_back(f); }};
    check_in(ctx, 1, 4);
    check_in(ctx, 0, 0);
    source.request_stop();
    EXPECT_THROW(check_in(ctx, 2, 4), Cancelled);
    EXPECT_THROW(part_of(ctx, 0, 1).throw_if_cancelled(), Cancelled);
    EXPECT_EQ(told, (std::vector<float>{0.25f}));
}

TEST(Progress, ALoopWithProgressRunsTheRangesOfALoopWithoutAndTellsOfSteps) {
    const auto ranges_of = [](const Context& ctx) {
        std::vector<std::size_t> end(100'003, 0);
        parallel_with_progress(ctx, end.size(), 7, [&](IndexRange r) {
            for (std::size_t i = r.begin; i < r.end; ++i) end[i] = r.end;
        });
        return end;
    };
    std::vector<float> told;
    const Context ctx{.threads = 2, .progress = [&](float f) { told.push_back(f); }};
    EXPECT_EQ(ranges_of(ctx), ranges_of({.threads = 2}));
    ASSERT_EQ(told.size(), 100u);
    for (std::size_t i = 0; i < told.size(); ++i)
        EXPECT_NEAR(told[i], 0.01 * static_cast<double>(i + 1), 0.006);
}

}  // namespace
}  // namespace coppice
