#include "coppice/points/wood_classes.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/base/progress.h"
#include "coppice/base/quote.h"

namespace coppice {
namespace {

constexpr std::size_t kGround = 2;
constexpr std::array<std::size_t, 12> kNeverWood{kGround, 6, 7, 9, 10, 11, 13, 14, 15, 16, 17, 18};
constexpr double kMinShare = 0.1;  // minimum share of the points that must remain

using Counts = std::array<std::uint64_t, 256>;

[[noreturn]] void bad_list(std::string_view text) {
    throw InvalidInput(fmt::format(
        "{} are not classes of points; write auto, all, or numbers from 0 to 255: 4,5,20-22", quote(text)));
}

/// Removes a number from 0 to 255 from the front of `rest` and returns it.
std::size_t take_class(std::string_view& rest, std::string_view text) {
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
    if (error != std::errc() || number > 255) bad_list(text);
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    return number;
}

Counts count_classes(const PointCloud& points) {
    Counts counts{};
    for (const std::uint8_t c : points.classes) ++counts[c];
    return counts;
}

std::string format_counts(const Counts& counts) {
    std::string text;
    for (std::size_t c = 0; c < counts.size(); ++c)
        if (counts[c] > 0) text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", c, counts[c]);
    return text;
}

/// Returns whether nine in ten points of the ground class are near the lowest points of their cells in plan
/// view: within a tenth of the total height, or within the possible rise of the ground in a cell.
bool is_ground_low(const PointCloud& points) {
    constexpr std::size_t kCells = 24;
    const Box3 box = bounds(points.points);
    const Vec3 size = box.high - box.low;
    const float cell = std::max({size.x, size.y, 1e-6f}) / kCells;
    const auto compute_cell = [&](Vec3 p) {
        const auto index = [&](float c) { return std::min(static_cast<std::size_t>(c / cell), kCells - 1); };
        return index(p.y - box.low.y) * kCells + index(p.x - box.low.x);
    };
    std::vector<float> lowest(kCells * kCells, std::numeric_limits<float>::infinity());
    const auto& positions = points.points.positions;
    for (const Vec3 p : positions) lowest[compute_cell(p)] = std::min(lowest[compute_cell(p)], p.z);
    const float reach = std::max(0.1f * size.z, cell);
    std::size_t ground = 0, low = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (points.classes[i] != kGround) continue;
        ++ground;
        if (positions[i].z <= lowest[compute_cell(positions[i])] + reach) ++low;
    }
    return 10 * low >= 9 * ground;
}

/// Returns the classes kept by the automatic rule.
std::bitset<256> automatic_classes(const PointCloud& points, const Counts& counts, bool keep_ground,
                                   std::optional<std::string>& doubt) {
    std::bitset<256> wood;
    wood.set();
    for (const std::size_t c : kNeverWood) wood.reset(c);
    wood.set(kGround, keep_ground);
    if (!keep_ground && counts[kGround] > 0 && !is_ground_low(points)) {
        wood.set(kGround);
        doubt = "points of class 2, which is ground, are not low: they were kept";
    }
    std::uint64_t left = 0;
    for (std::size_t c = 0; c < counts.size(); ++c) left += wood[c] ? counts[c] : 0;
    if (static_cast<double>(left) < kMinShare * static_cast<double>(points.points.size())) {
        wood.set();
        doubt = fmt::format("by their classes only {} of {} points could be trees: all were kept", left,
                            points.points.size());
    }
    return wood;
}

}  // namespace

WoodClasses parse_wood_classes(std::string_view text) {
    if (text == "auto") return {};
    WoodClasses wood{.automatic = false};
    if (text == "all") {
        wood.classes.set();
        return wood;
    }
    for (std::string_view rest = text;; rest.remove_prefix(1)) {
        const std::size_t first = take_class(rest, text);
        std::size_t last = first;
        if (rest.starts_with('-')) {
            rest.remove_prefix(1);
            last = take_class(rest, text);
        }
        if (last < first || (!rest.empty() && rest.front() != ',')) bad_list(text);
        for (std::size_t c = first; c <= last; ++c) wood.classes.set(c);
        if (rest.empty()) return wood;
    }
}

ClassSelection keep_wood_classes(PointCloud& points, const WoodClasses& wood, const Context& ctx) {
    ClassSelection out;
    if (points.classes.empty()) {
        if (wood.automatic || wood.classes.all()) return out;
        throw InvalidInput("its points have no classes to choose from");
    }
    const Counts counts = count_classes(points);
    ctx.throw_if_cancelled();
    const std::bitset<256> kept =
        wood.automatic ? automatic_classes(points, counts, wood.ground, out.doubt) : wood.classes;
    for (std::size_t c = 0; c < counts.size(); ++c) {
        if (kept[c]) continue;
        out.left_out[c] = counts[c];
        out.count += counts[c];
    }
    if (out.count == 0) return out;
    if (out.count == points.points.size()) {
        throw InvalidInput(
            fmt::format("no point has one of the requested classes; there are {}", format_counts(counts)));
    }
    std::vector<std::uint8_t> is_kept(points.classes.size());
    std::ranges::transform(points.classes, is_kept.begin(),
                           [&](std::uint8_t c) { return std::uint8_t{kept[c]}; });
    keep_values(points.points.positions, is_kept);
    visit_columns(points, [&](auto& column) { keep_values(column, is_kept); });
    return out;
}

}  // namespace coppice
