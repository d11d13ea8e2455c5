#include "coppice/scene/extraction.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/base/progress.h"
#include "coppice/options/quantity.h"

namespace coppice {

PlotExtraction extract_trees_by_ids(const PointCloud& scan, const CloudOptions& options, const Context& ctx) {
    constexpr float kSegmented = 0.1f;  // fraction of the progress
    if (scan.tree_ids.empty())
        throw InvalidInput(
            "its points have no ids of trees; these are read from a column, property or extra dimension "
            "tree_id, treeID, PredInstance, instance or label");
    PlotSegments segments =
        segment_plot_by_ids(scan.points, scan.tree_ids, narrow_progress(ctx, 0, kSegmented));
    if (segments.trees.empty()) throw InvalidInput("extract: no tree id has at least 50 points");
    return extract_trees(scan.points, std::move(segments), options, narrow_progress(ctx, kSegmented, 1));
}

std::vector<NodeAttribute> node_attributes(std::span<const NodeConfidence> confidence, bool cloud) {
    std::vector<NodeAttribute> out{{"samples", {}}, {"residual", {}}};
    if (cloud) out.insert(out.end(), {{"radius_low", {}}, {"radius_high", {}}, {"evidence", {}}});
    for (const NodeConfidence& c : confidence) {
        const std::array<float, 5> values{static_cast<float>(c.samples), c.residual, c.radius_low,
                                          c.radius_high, c.evidence};
        for (std::size_t k = 0; k < out.size(); ++k) out[k].values.push_back(values[k]);
    }
    return out;
}

std::vector<NodeConfidence> node_confidence(std::span<const NodeAttribute> attributes) {
    const auto named = [&](std::string_view name) {
        const auto found = std::ranges::find(attributes, name, &NodeAttribute::name);
        return found == attributes.end() ? std::span<const float>() : std::span<const float>(found->values);
    };
    const auto samples = named("samples"), residual = named("residual"), low = named("radius_low"),
               high = named("radius_high"), evidence = named("evidence");
    if (samples.empty() || residual.empty() || low.empty() || high.empty() || evidence.empty()) return {};
    std::vector<NodeConfidence> out;
    for (std::size_t n = 0; n < samples.size(); ++n) {
        out.push_back({.samples = static_cast<std::uint32_t>(std::clamp(samples[n], 0.0f, 1e9f)),
                       .residual = residual[n],
                       .radius_low = low[n],
                       .radius_high = high[n],
                       .evidence = std::clamp(evidence[n], 0.0f, 1.0f)});
    }
    return out;
}

std::string text_of_points_left_out(const CloudReport& cleaning) {
    std::string out;
    if (cleaning.downsampled > 0) {
        out += fmt::format(", {} points thinned by {}", grouped(cleaning.points - cleaning.duplicates),
                           grouped(cleaning.downsampled));
    }
    const auto add = [&](std::uint64_t count, std::string_view why) {
        if (count > 0)
            out += fmt::format(", {} of {} points {}", grouped(count), grouped(cleaning.points), why);
    };
    add(cleaning.leaves, "left out as leaves");
    add(cleaning.understorey, "left out as understorey");
    add(cleaning.unreached, "left out beyond gaps");
    return out;
}

std::string text_of_tree(const TreeFigures& tree) {
    std::string out = fmt::format(", height {:.1f} m", tree.height);
    if (tree.height_high > 0) out += fmt::format(" ({:.1f} to {:.1f})", tree.height_low, tree.height_high);
    if (tree.dbh > 0) out += fmt::format(", DBH {:.1f} cm", 100 * tree.dbh);
    if (tree.dbh_of_points > 0) {
        out += fmt::format(" ({:.1f}, {:.1f} to {:.1f}, in the points)", 100 * tree.dbh_of_points,
                           100 * tree.dbh_low, 100 * tree.dbh_high);
    }
    return out + fmt::format(
                     ", length {:.3g} m ({:.3g} to {:.3g}), {:.2g} m3 ({:.2g} to {:.2g}), {:.0f} % inferred",
                     tree.length, tree.length_low, tree.length_high, tree.volume, tree.volume_low,
                     tree.volume_high, 100 * tree.inferred);
}

}  // namespace coppice
