#pragma once

#include <cstdint>
#include <vector>

namespace coppice {

/// Distribution of a quantity. Quantiles are members of the sample, not interpolated: of n sorted values p1
/// is number n / 100, p5 number n / 20, p50 number n / 2 (rounded down, from 0), and p95 and p99 are as far
/// from the end as p5 and p1 from the start. All are 0 if n is 0.
struct Statistics {
    std::uint64_t n = 0;                                                     ///< number of values
    double mean = 0;                                                         ///< mean of the values
    double mean_abs = 0;                                                     ///< mean of the absolute values
    double p1 = 0;                                                           ///< 1 % quantile
    double p5 = 0;                                                           ///< 5 % quantile
    double p50 = 0;                                                          ///< median
    double p95 = 0;                                                          ///< 95 % quantile
    double p99 = 0;                                                          ///< 99 % quantile
    double min = 0;                                                          ///< minimum
    double max = 0;                                                          ///< maximum
    friend bool operator==(const Statistics&, const Statistics&) = default;  ///< compares all members
};

/// Computes the statistics of finite values. O(n).
Statistics statistics(std::vector<double> values);

/// Calls visit(name, number) for every member, in order.
template <class Visitor>
void visit_figures(const Statistics& s, Visitor&& visit) {
    visit("n", s.n);
    if (s.n == 0) return;
    visit("mean", s.mean);
    visit("mean_abs", s.mean_abs);
    visit("p1", s.p1);
    visit("p5", s.p5);
    visit("p50", s.p50);
    visit("p95", s.p95);
    visit("p99", s.p99);
    visit("min", s.min);
    visit("max", s.max);
}

}  // namespace coppice
