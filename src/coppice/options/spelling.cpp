#include "coppice/options/spelling.h"

#include <algorithm>
#include <vector>

#include "coppice/base/ascii.h"

namespace coppice {
namespace {

constexpr std::size_t kLongestWord = 64;    // longer words are not typing errors
constexpr std::size_t kShortestPrefix = 3;  // shorter ones match too many words

std::string folded(std::string_view word) {
    std::string out = to_lower(word);
    std::ranges::replace(out, '_', '-');
    return out;
}

/// Returns the optimal string alignment distance: single edits and swaps of adjacent letters.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0u : 1u)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
        std::swap(before, last);
        std::swap(last, row);
    }
    return last[b.size()];
}

std::string shortest_with_prefix(std::string_view prefix, std::span<const std::string> candidates) {
    if (prefix.size() < kShortestPrefix) return {};
    std::string best;
    for (const std::string& candidate : candidates) {
        const bool shorter = best.empty() || candidate.size() < best.size();
        if (shorter && folded(candidate).starts_with(prefix)) best = candidate;
    }
    return best;
}

}  // namespace

std::string nearest_spelling(std::string_view word, std::span<const std::string> candidates) {
    if (word.size() > kLongestWord) return {};
    const std::string wanted = folded(word);
    std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
    std::string best;
    for (const std::string& candidate : candidates) {
        const std::size_t d = edit_distance(wanted, folded(candidate));
        if (d < least) {
            least = d;
            best = candidate;
        }
    }
    return best.empty() ? shortest_with_prefix(wanted, candidates) : best;
}

std::string did_you_mean(std::string_view word, std::span<const std::string> candidates) {
    const std::string best = nearest_spelling(word, candidates);
    return best.empty() ? best : "; did you mean " + best + "?";
}

}  // namespace coppice
