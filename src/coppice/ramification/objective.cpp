#include "coppice/ramification/objective_internal.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coppice {
namespace {

Vec3d compute_center(std::span<const Vec3d> loop) {
    Vec3d sum;
    for (const Vec3d p : loop) sum += p;
    return sum / static_cast<double>(loop.size());
}

/// Returns the cosine distance of the direction (along, side) from the diagonal.
double off_diagonal(double along, double side) {
    const double l = std::hypot(along, side);
    return l > 0 ? 1 - (along + side) / (std::numbers::sqrt2 * l) : 0;
}

}  // namespace

double cosine_distance(Vec3d a, Vec3d b) {
    const double l = length(a) * length(b);
    return l > 0 ? 1 - dot(a, b) / l : 0;
}

double unit_distortion(double down, double up, double side) {
    return 2 * (off_diagonal(down, side) + off_diagonal(up, side));
}

double connection_distortion(double twist, double gap, double diameter) {
    const double likeness = std::cos(twist);
    return 4 * (1 - likeness + std::max(0.0, 1 - gap / diameter) * likeness);
}

std::uint32_t best_turn(std::span<const Vec3d> first, std::span<const Vec3d> second, Vec3d normal) {
    const std::size_t m = first.size();
    const Vec3d a = compute_center(first), b = compute_center(second);
    const auto flat = [&](Vec3d v) { return v - normal * dot(normal, v); };
    std::uint32_t best = 0;
    double least = 0;
    for (std::size_t turn = 0; turn < m; ++turn) {
        double sum = 0;
        for (std::size_t k = 0; k < m; ++k)
            sum += cosine_distance(flat(first[k] - a), flat(second[(k + turn) % m] - b));
        if (turn == 0 || sum < least) {
            least = sum;
            best = static_cast<std::uint32_t>(turn);
        }
    }
    return best;
}

double paste_distortion(std::span<const Vec3d> sub, std::span<const Vec3d> place, double diameter) {
    constexpr double kBeta = 0.5;
    const Vec3d a = compute_center(sub), b = compute_center(place);
    double directions = 0, lengths = 0;
    for (std::size_t k = 0; k < sub.size(); ++k) {
        directions += cosine_distance(sub[k] - a, place[k] - b);
        lengths += distance(sub[k], place[k]);
    }
    return kBeta * directions + (1 - kBeta) * lengths / diameter;
}

}  // namespace coppice
