#include "coppice/render/silhouette.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "coppice/base/error.h"
#include "coppice/base/median.h"

namespace coppice {
namespace {

std::array<int, 3> find_background(const Image& image) {
    std::array<std::vector<std::uint8_t>, 3> edge;
    const auto add = [&](int x, int y) {
        for (std::size_t c = 0; c < 3; ++c) edge[c].push_back(image.at(x, y)[c]);
    };
    for (int x = 0; x < image.width; ++x) add(x, 0), add(x, image.height - 1);
    for (int y = 0; y < image.height; ++y) add(0, y), add(image.width - 1, y);
    return {median(edge[0]), median(edge[1]), median(edge[2])};
}

/// Returns the threshold that splits a histogram into two with the minimum variance within both [Otsu1979].
int compute_threshold(const std::vector<double>& counts) {
    double all = 0, sum = 0;
    for (std::size_t i = 0; i < counts.size(); ++i)
        all += counts[i], sum += static_cast<double>(i) * counts[i];
    double below = 0, sum_below = 0, best = -1;
    int threshold = 0;
    for (std::size_t i = 0; i + 1 < counts.size(); ++i) {
        below += counts[i];
        sum_below += static_cast<double>(i) * counts[i];
        if (below == 0 || below == all) continue;
        const double apart = sum_below / below - (sum - sum_below) / (all - below);
        const double between = below * (all - below) * apart * apart;
        if (between > best) best = between, threshold = static_cast<int>(i);
    }
    return threshold;
}

}  // namespace

Mask compute_silhouette(const Image& image) {
    if (image.pixels.empty()) throw InvalidInput("an image without pixels has no silhouette");
    Mask mask(image.width, image.height);
    if (std::ranges::any_of(image.pixels, [](const auto& p) { return p[3] < 128; })) {
        for (std::size_t i = 0; i < mask.inside.size(); ++i)
            mask.inside[i] = image.pixels[i][3] >= 128 ? 1 : 0;
        return mask;
    }
    const std::array<int, 3> background = find_background(image);
    std::vector<int> off;
    std::vector<double> counts(3 * 256, 0);
    for (const Image::Pixel& p : image.pixels) {
        int sum = 0;
        for (std::size_t c = 0; c < 3; ++c) sum += std::abs(int{p[c]} - background[c]);
        off.push_back(sum);
        ++counts[static_cast<std::size_t>(sum)];
    }
    const int threshold = compute_threshold(counts);
    for (std::size_t i = 0; i < off.size(); ++i) mask.inside[i] = off[i] > threshold ? 1 : 0;
    return mask;
}

}  // namespace coppice
