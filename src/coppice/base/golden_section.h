#pragma once

namespace coppice {

/// Returns the place of the minimum of a unimodal function in [low, high] to within the tolerance > 0, by
/// golden-section search. O(log((high - low) / tolerance)) evaluations.
template <class Function>
double find_minimum(double low, double high, double tolerance, const Function& f) {
    constexpr double kGolden = 0.6180339887498949;
    double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    double fa = f(a), fb = f(b);
    while (high - low > tolerance) {
        if (fa <= fb) {
            high = b;
            b = a;
            fb = fa;
            a = high - kGolden * (high - low);
            fa = f(a);
        } else {
            low = a;
            a = b;
            fa = fb;
            b = low + kGolden * (high - low);
            fb = f(b);
        }
    }
    return (low + high) / 2;
}

}  // namespace coppice
