#include "plot_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

#include "coppice/skeleton/measure.h"

namespace coppice::bench {
namespace {

constexpr std::size_t kUnmatched = static_cast<std::size_t>(-1);

/// Returns the true tree of each found one, matching the closest pairs first.
std::vector<std::size_t> match(const PlotScene& scene, const PlotExtraction& found) {
    std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
    for (std::size_t t = 0; t < scene.trees.size(); ++t) {
        const TrueTree& tree = scene.trees[t];
        for (std::size_t k = 0; k < found.trees.size(); ++k) {
            const StemForm& form = found.trees[k].form;
            const Vec3d at = form.breast.diameter > 0 ? form.breast.center : form.foot;
            const double off = std::hypot(at.x - tree.at_breast.x, at.y - tree.at_breast.y);
            if (off < std::max(0.3, tree.dbh)) pairs.emplace_back(off, t, k);
        }
    }
    std::ranges::sort(pairs);
    std::vector<std::size_t> truth(found.trees.size(), kUnmatched);
    std::vector<char> taken(scene.trees.size());
    for (const auto& [off, t, k] : pairs) {
        if (taken[t] || truth[k] != kUnmatched) continue;
        taken[t] = 1;
        truth[k] = t;
    }
    return truth;
}

void judge_points(const PlotScene& scene, const PlotSegments& segments, const std::vector<std::size_t>& truth,
                  PlotScore& score) {
    std::vector<double> all(scene.trees.size()), right(scene.trees.size());
    double given = 0, ground = 0, ground_right = 0;
    for (std::size_t i = 0; i < scene.owner.size(); ++i) {
        const std::uint32_t owner = scene.owner[i], tree = segments.tree_of[i];
        if (owner == kGroundOwner) {
            ++ground;
            ground_right += tree == kPointOfGround;
        }
        if (owner < scene.trees.size() && scene.leaf[i]) continue;
        given += tree < truth.size();
        if (owner >= scene.trees.size()) continue;
        all[owner] += 1;
        right[owner] += tree < truth.size() && truth[tree] == owner;
    }
    double wood = 0, wood_right = 0;
    score.min_right = 1;
    for (std::size_t t = 0; t < all.size(); ++t) {
        wood += all[t];
        wood_right += right[t];
        if (all[t] > 0) score.min_right = std::min(score.min_right, right[t] / all[t]);
    }
    score.wood = static_cast<std::size_t>(wood);
    score.wood_right = wood_right / std::max(wood, 1.0);
    score.given_right = wood_right / std::max(given, 1.0);
    score.ground_right = ground_right / std::max(ground, 1.0);
}

}  // namespace

PlotScore judge_plot(const PlotScene& scene, const PlotExtraction& found) {
    PlotScore score{.plot = scene.name, .trees = scene.trees.size(), .points = scene.points.size()};
    const auto truth = match(scene, found);
    judge_points(scene, found.segments, truth, score);
    double length = 0, volume = 0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
        const PlotTree& tree = found.trees[k];
        score.failed += !tree.result;
        score.length += tree.figures.length;
        score.volume += tree.figures.volume;
        if (truth[k] == kUnmatched) {
            ++score.wrong;
            continue;
        }
        ++score.found;
        const TrueTree& is = scene.trees[truth[k]];
        const double off = tree.form.breast.diameter / is.dbh - 1;
        score.dbh_mean += std::abs(off);
        score.dbh_bias += off;
        score.dbh_worst = std::max(score.dbh_worst, std::abs(off));
        score.height_mean += std::abs(tree.form.height / is.height - 1);
    }
    const double count = std::max<double>(1, static_cast<double>(score.found));
    score.dbh_mean /= count;
    score.dbh_bias /= count;
    score.height_mean /= count;
    for (const TrueTree& tree : scene.trees) {
        const SkeletonMeasures m = measure(tree.skeleton);
        length += m.length;
        volume += m.volume;
    }
    score.length /= length;
    score.volume /= volume;
    return score;
}

std::string plot_markdown(const std::vector<PlotScore>& scores) {
    std::string out =
        "| trees:points | points on wood | trees found | false | wood right % | worst tree % | of points "
        "given % | "
        "ground right % | DBH error % | bias % | worst % | height error % | length | volume | failed | s | "
        "peak MiB |\n|";
    for (int i = 0; i < 17; ++i) out += " --- |";
    out += "\n";
    for (const PlotScore& s : scores) {
        fmt::format_to(std::back_inserter(out),
                       "| {} | {} | {} of {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:+.1f} | "
                       "{:.1f} | {:.1f} "
                       "| {:.2f} | {:.2f} | {} | {:.1f} | {} |\n",
                       s.plot, s.wood, s.found, s.trees, s.wrong, 100 * s.wood_right, 100 * s.min_right,
                       100 * s.given_right, 100 * s.ground_right, 100 * s.dbh_mean, 100 * s.dbh_bias,
                       100 * s.dbh_worst, 100 * s.height_mean, s.length, s.volume, s.failed, s.seconds,
                       s.peak_bytes >> 20);
    }
    return out;
}

}  // namespace coppice::bench
