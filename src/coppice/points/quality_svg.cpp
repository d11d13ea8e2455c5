#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "coppice/points/quality.h"

namespace coppice {
namespace {

constexpr double kWidth = 420, kHeight = 260, kLeft = 56, kTop = 36;  // dimensions of one plot

struct Curve {
    std::string_view title, axis;
    const std::vector<double>& values;
    double first, step;  ///< positions of the values on the axis
};

/// Returns the maximum of the axis: 2, or the maximum of the curve if that is larger.
double compute_top(const std::vector<double>& values) {
    double top = 2;
    for (const double v : values) {
        if (std::isfinite(v)) top = std::max(top, std::min(v, 1e6));
    }
    return top;
}

void plot(const Curve& curve, double left, std::string& svg) {
    const auto out = std::back_inserter(svg);
    const double top = compute_top(curve.values);
    const double end = curve.first + curve.step * static_cast<double>(curve.values.size());
    const auto x = [&](double v) { return left + (end > 0 ? v / end : 0) * kWidth; };
    const auto y = [&](double v) { return kTop + kHeight * (1 - std::clamp(v / top, 0.0, 1.0)); };
    fmt::format_to(out, "<text x=\"{:.1f}\" y=\"22\" font-size=\"15\">{}</text>\n", left, curve.title);
    fmt::format_to(out,
                   "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.0f}\" height=\"{:.0f}\" fill=\"none\" "
                   "stroke=\"#888\"/>\n",
                   left, kTop, kWidth, kHeight);
    for (const double v : {0.0, 1.0, top}) {
        fmt::format_to(out, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{:.3g}</text>\n", left - 6,
                       y(v) + 4, v);
    }
    fmt::format_to(out, "<path d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"#bbb\" stroke-dasharray=\"4 4\"/>\n",
                   left, y(1), left + kWidth);
    for (int i = 0; i <= 4; ++i) {
        const double v = end * i / 4;
        fmt::format_to(out, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:.3g}</text>\n", x(v),
                       kTop + kHeight + 18, v);
    }
    fmt::format_to(out, "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                   left + kWidth / 2, kTop + kHeight + 38, curve.axis);
    svg += "<path fill=\"none\" stroke=\"#1f5fa8\" stroke-width=\"1.5\" d=\"";
    for (std::size_t i = 0; i < curve.values.size(); ++i) {
        const double v = std::isfinite(curve.values[i]) ? curve.values[i] : 0;
        fmt::format_to(out, "{}{:.2f} {:.2f}", i == 0 ? 'M' : 'L',
                       x(curve.first + curve.step * static_cast<double>(i)), y(v));
    }
    svg += "\"/>\n";
}

}  // namespace

std::string quality_svg(const QualityReport& report) {
    const double width = 2 * (kWidth + kLeft) + 40, height = kTop + kHeight + 76;
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 "
        "{0:.0f} {1:.0f}\" "
        "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" "
        "fill=\"#fff\"/>\n",
        width, height);
    plot({"Radial distribution", "distance [m]", report.distribution, report.distance_step / 2,
          report.distance_step},
         kLeft, svg);
    plot({"Radially averaged power", "frequency [1/m]", report.power, report.frequency_step,
          report.frequency_step},
         2 * kLeft + kWidth + 20, svg);
    fmt::format_to(std::back_inserter(svg),
                   "<text x=\"{:.0f}\" y=\"{:.0f}\">{} points, minimum distance {:.4g} m, mean distance "
                   "{:.4g} m to the closest point, power at low frequency {:.3g}</text>\n</svg>\n",
                   kLeft, height - 12, report.points, report.min_distance, report.mean_distance,
                   report.low_power);
    return svg;
}

}  // namespace coppice
