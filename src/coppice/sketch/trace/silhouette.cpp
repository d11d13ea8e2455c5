#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "coppice/sketch/trace/silhouette_internal.h"

namespace coppice::sketch_internal {
namespace {

/// Neighbours of a pixel, clockwise from the one above it.
constexpr std::array<std::array<int, 2>, 8> kAround{
    {{0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}}};

/// One-dimensional squared distance transform by the lower envelope of parabolas on `f` (Felzenszwalb and
/// Huttenlocher).
class Envelope {
  public:
    void run(std::vector<double>& f) {
        const std::size_t n = f.size();
        at_.assign(n, 0);
        from_.assign(n + 1, 0);
        std::size_t k = 0;
        from_[0] = -std::numeric_limits<double>::infinity();
        from_[1] = std::numeric_limits<double>::infinity();
        for (std::size_t q = 1; q < n; ++q) {
            double s = crossing(f, q, at_[k]);
            while (s <= from_[k]) s = crossing(f, q, at_[--k]);
            at_[++k] = q;
            from_[k] = s;
            from_[k + 1] = std::numeric_limits<double>::infinity();
        }
        out_.resize(n);
        k = 0;
        for (std::size_t q = 0; q < n; ++q) {
            while (from_[k + 1] < static_cast<double>(q)) ++k;
            const double d = static_cast<double>(q) - static_cast<double>(at_[k]);
            out_[q] = d * d + f[at_[k]];
        }
        f = out_;
    }

  private:
    static double crossing(const std::vector<double>& f, std::size_t q, std::size_t p) {
        const auto x = static_cast<double>(q), y = static_cast<double>(p);
        return ((f[q] + x * x) - (f[p] + y * y)) / (2 * x - 2 * y);
    }
    std::vector<std::size_t> at_;
    std::vector<double> from_, out_;
};

/// Returns whether one of the two passes of Zhang and Suen removes a pixel.
bool may_go(const Mask& mask, int x, int y, bool second) {
    std::array<bool, 8> on{};
    int count = 0, changes = 0;
    for (std::size_t k = 0; k < 8; ++k) {
        on[k] = mask.at(x + kAround[k][0], y + kAround[k][1]);
        count += on[k] ? 1 : 0;
    }
    for (std::size_t k = 0; k < 8; ++k) changes += !on[k] && on[(k + 1) % 8] ? 1 : 0;
    if (count < 2 || count > 6 || changes != 1) return false;
    const bool up = on[0], right = on[2], down = on[4], left = on[6];
    return second ? !(up && right && left) && !(up && down && left)
                  : !(up && right && down) && !(right && down && left);
}

/// Returns whether a pixel that is not an end can be removed without disconnecting the line, as at the
/// corners of stairs.
bool is_corner(const Mask& mask, int x, int y) {
    std::array<bool, 8> on{};
    int count = 0, runs = 0;
    for (std::size_t k = 0; k < 8; ++k) {
        on[k] = mask.at(x + kAround[k][0], y + kAround[k][1]);
        count += on[k] ? 1 : 0;
    }
    for (std::size_t k = 0; k < 8; k += 2) runs += !on[k] && (on[k + 1] || on[(k + 2) % 8]) ? 1 : 0;
    return count >= 2 && runs == 1;
}

/// Returns the distances [pixels] from the centre of every pixel to the closest one inside, or outside.
std::vector<float> distances(const Mask& mask, bool to_inside) {
    // A border of outside pixels ends silhouettes that touch the edge of the image.
    const int width = mask.width + 2, height = mask.height + 2;
    const auto columns = static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
    constexpr double kFar = 1e12;
    std::vector<double> squared;
    for (int y = -1; y <= mask.height; ++y)
        for (int x = -1; x <= mask.width; ++x) squared.push_back(mask.at(x, y) == to_inside ? 0 : kFar);
    Envelope envelope;
    std::vector<double> line;
    for (std::size_t x = 0; x < columns; ++x) {
        line.resize(rows);
        for (std::size_t y = 0; y < rows; ++y) line[y] = squared[y * columns + x];
        envelope.run(line);
        for (std::size_t y = 0; y < rows; ++y) squared[y * columns + x] = line[y];
    }
    std::vector<float> out(mask.inside.size());
    for (std::size_t y = 1; y + 1 < rows; ++y) {
        line.assign(squared.begin() + static_cast<std::ptrdiff_t>(y * columns),
                    squared.begin() + static_cast<std::ptrdiff_t>((y + 1) * columns));
        envelope.run(line);
        for (std::size_t x = 1; x + 1 < columns; ++x)
            out[mask.index(static_cast<int>(x - 1), static_cast<int>(y - 1))] =
                static_cast<float>(std::sqrt(line[x]));
    }
    return out;
}

}  // namespace

std::vector<float> distance_to_outside(const Mask& mask) { return distances(mask, false); }

std::vector<float> distance_to_inside(const Mask& mask) { return distances(mask, true); }

Mask thinned(Mask mask, const Context& ctx) {
    std::vector<std::array<int, 2>> left;
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x)
            if (mask.at(x, y)) left.push_back({x, y});
    for (bool changed = true; changed;) {
        ctx.throw_if_cancelled();
        changed = false;
        for (const bool second : {false, true}) {
            std::vector<std::size_t> going;
            for (const auto& [x, y] : left)
                if (may_go(mask, x, y, second)) going.push_back(mask.index(x, y));
            for (const std::size_t i : going) mask.inside[i] = 0;
            if (going.empty()) continue;
            changed = true;
            std::erase_if(left, [&](const auto& p) { return !mask.at(p[0], p[1]); });
        }
    }
    for (const auto& [x, y] : left)
        if (is_corner(mask, x, y)) mask.inside[mask.index(x, y)] = 0;
    return mask;
}

Mask largest_part(const Mask& mask) {
    std::vector<std::uint32_t> part(mask.inside.size(), 0);
    std::vector<std::array<int, 2>> stack;
    std::uint32_t parts = 0, largest = 0;
    std::size_t most = 0;
    for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
            if (!mask.at(x, y) || part[mask.index(x, y)] != 0) continue;
            std::size_t size = 0;
            ++parts;
            part[mask.index(x, y)] = parts;
            stack.push_back({x, y});
            while (!stack.empty()) {
                const auto [px, py] = stack.back();
                stack.pop_back();
                ++size;
                for (const auto& [dx, dy] : kAround) {
                    if (!mask.at(px + dx, py + dy) || part[mask.index(px + dx, py + dy)] != 0) continue;
                    part[mask.index(px + dx, py + dy)] = parts;
                    stack.push_back({px + dx, py + dy});
                }
            }
            if (size > most) most = size, largest = parts;
        }
    }
    Mask out = mask;
    for (std::size_t i = 0; i < part.size(); ++i) out.inside[i] = part[i] == largest && largest != 0 ? 1 : 0;
    return out;
}

}  // namespace coppice::sketch_internal
