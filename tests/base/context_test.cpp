#include "coppice/base/context.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "errors.h"

namespace coppice {
namespace {

TEST(Context, DefaultNeitherStopsNorReports) {
    const Context ctx;
    EXPECT_EQ(ctx.threads, 0u);
    EXPECT_EQ(test::error_of<Error>([&] { ctx.throw_if_cancelled(); }), "no error");
    EXPECT_EQ(test::error_of<std::exception>([&] { ctx.report(0.5f); }), "no error");
}

TEST(Context, ThrowsOnceAStopIsRequested) {
    std::stop_source source;
    const Context ctx{.stop = source.get_token()};
    EXPECT_EQ(test::error_of<Cancelled>([&] { ctx.throw_if_cancelled(); }), "no error");
    source.request_stop();
    EXPECT_EQ(test::error_of<Cancelled>([&] { ctx.throw_if_cancelled(); }), "interrupted");
    const Context copy = ctx;
    EXPECT_THROW(copy.throw_if_cancelled(), Cancelled);
}

TEST(Context, ForwardsEveryFraction) {
    std::vector<float> reported;
    const Context ctx{.progress = [&](float fraction) { reported.push_back(fraction); }};
    ctx.report(0);
    ctx.report(0.25f);
    ctx.report(1);
    EXPECT_EQ(reported, (std::vector<float>{0, 0.25f, 1}));
}

}  // namespace
}  // namespace coppice
