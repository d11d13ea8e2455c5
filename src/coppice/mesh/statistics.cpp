#include "coppice/mesh/statistics.h"

#include <algorithm>
#include <cmath>

namespace coppice {

Statistics statistics(std::vector<double> values) {
    const std::size_t n = values.size();
    if (n == 0) return {};
    Statistics s{.n = n};
    for (const double v : values) {
        s.mean += v;
        s.mean_abs += std::fabs(v);
    }
    s.mean /= static_cast<double>(n);
    s.mean_abs /= static_cast<double>(n);
    // Ranks never decrease, so that each selection only processes the values after the previous one.
    auto begin = values.begin();
    const auto rank = [&](std::size_t k) {
        const auto at = values.begin() + static_cast<std::ptrdiff_t>(k);
        std::nth_element(begin, at, values.end());
        begin = at;
        return *at;
    };
    s.p1 = rank(n / 100);
    s.min = *std::min_element(values.begin(), begin + 1);
    s.p5 = rank(n / 20);
    s.p50 = rank(n / 2);
    s.p95 = rank(n - 1 - n / 20);
    s.p99 = rank(n - 1 - n / 100);
    s.max = *std::max_element(begin, values.end());
    return s;
}

}  // namespace coppice
