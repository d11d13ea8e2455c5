#include "coppice/extract/prior/smooth_axes_internal.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/extract/tree/tree_edit_internal.h"

namespace coppice::extract_internal {
namespace {

constexpr double kOfSpacing = 0.05;     // [spacing] minimum error of any node
constexpr double kBendPerLength = 0.8;  // [rad] usual change of direction of an axis over kBendLength
constexpr double kBendLength = 20;      // [radius]
constexpr double kMinBend = 0.05;
constexpr double kMaxBend = 0.8;  // [rad] range of the usual change of direction at one node
constexpr double kSharp = 0.6;    // [cos] turns sharper than this are straightened: 53 degrees
// Minimum arm of a turn, relative to the sum of both and to the radius: shorter arms do not define a
// direction.
constexpr double kShortArm = 0.1, kShortest = 0.05;
constexpr double kStiffer = 8;  // factor of the stiffness each time that a turn is still too sharp
constexpr int kMaxPasses = 8;
constexpr double kFixedError = 1e-3;  // [radius] error of the position of fixed nodes

/// Three consecutive nodes on one axis.
struct Turn {
    std::uint32_t before, at, after;
    double stiffness;  ///< inverse variance of the change of direction [1/rad^2]
    bool fork;         ///< whether the axis may turn sharply here
};

double turn_cosine(const InitialTree& tree, const Turn& t) {
    const Vec3d a = tree.position[t.at] - tree.position[t.before];
    const Vec3d b = tree.position[t.after] - tree.position[t.at];
    const double l = length(a) * length(b);
    return l > 0 ? dot(a, b) / l : 1;
}

std::vector<Turn> compute_turns(const InitialTree& tree) {
    const std::vector<std::uint32_t> next = axis_children(tree);
    const InitialTreeLinks links(tree);
    std::vector<Turn> turns;
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const std::uint32_t q = tree.parent[n], c = next[n];
        if (q == kNoIndex || c == kNoIndex) continue;
        const double way = 0.5 * (distance(tree.position[q], tree.position[n]) +
                                  distance(tree.position[n], tree.position[c]));
        if (!(way > 0)) continue;  // the nodes coincide
        const double bend =
            std::clamp(kBendPerLength * std::sqrt(way / (kBendLength * tree.radius[n])), kMinBend, kMaxBend);
        turns.push_back({q, n, c, 1 / (bend * bend), links.children(n).size() > 1});
    }
    return turns;
}

/// Returns the inverse variance of the position of a node [1/m^2].
double place_precision(const NodeEvidence& e, double radius) {
    // Points that fill a branch do not determine its centre, regardless of their number.
    const double share = e.filled(), floor = kOfSpacing * e.spacing;
    const double spread = e.own > 0 ? std::max(e.scatter, share * e.radius) : radius + e.spacing;
    const double variance = spread * spread * ((1 - share) / std::max(e.own, 1.0) + share) + floor * floor;
    return 1 / std::max({variance, 1e-6 * radius * radius, std::numeric_limits<double>::min()});
}

using Matrix = Eigen::SparseMatrix<double>;
using Solver = Eigen::SimplicialLDLT<Matrix, Eigen::Lower, Eigen::NaturalOrdering<int>>;

/// Returns the positions of the nodes that balance their target places and the stiffness of the turns.
std::vector<Vec3d> solve(const InitialTree& tree, std::span<const Vec3d> place,
                         std::span<const double> precision, std::span<const Turn> turns) {
    const auto size = static_cast<Eigen::Index>(tree.size());
    // Nodes are eliminated from the tips to the root.
    const auto row = [&](std::uint32_t n) { return static_cast<int>(tree.size() - 1 - n); };
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(tree.size() + 6 * turns.size());
    Eigen::MatrixX3d right(size, 3);
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        entries.emplace_back(row(n), row(n), precision[n]);
        right.row(row(n)) << precision[n] * place[n].x, precision[n] * place[n].y, precision[n] * place[n].z;
    }
    for (const Turn& t : turns) {
        const double first = distance(tree.position[t.before], tree.position[t.at]);
        const double second = distance(tree.position[t.at], tree.position[t.after]);
        const double least = std::max(kShortArm * (first + second), kShortest * tree.radius[t.at]);
        const double before = 1 / std::max(first, least), after = 1 / std::max(second, least);
        const std::array<std::pair<std::uint32_t, double>, 3> terms{
            {{t.before, before}, {t.at, -before - after}, {t.after, after}}};
        for (const auto& [a, x] : terms)
            for (const auto& [b, y] : terms)
                if (row(a) >= row(b)) entries.emplace_back(row(a), row(b), t.stiffness * x * y);
    }
    Matrix matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Solver solver(matrix);
    std::vector<Vec3d> out(tree.position);
    if (solver.info() != Eigen::Success) return out;
    const Eigen::MatrixX3d solution = solver.solve(right);
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const Vec3d p(solution(row(n), 0), solution(row(n), 1), solution(row(n), 2));
        if (is_finite(p)) out[n] = p;
    }
    return out;
}

}  // namespace

void smooth_axes(InitialTree& tree, std::span<const NodeEvidence> evidence, const Context& ctx) {
    std::vector<Turn> turns = compute_turns(tree);
    const std::vector<Vec3d> place = tree.position;
    std::vector<double> precision(tree.size());
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const double error = kFixedError * tree.radius[n];
        precision[n] = tree.fixed[n] ? 1 / (error * error) : place_precision(evidence[n], tree.radius[n]);
    }
    for (int pass = 0; pass < kMaxPasses; ++pass) {
        ctx.throw_if_cancelled();
        tree.position = solve(tree, place, precision, turns);
        for (std::uint32_t n = 0; n < tree.size(); ++n)
            if (tree.fixed[n]) tree.position[n] = place[n];
        bool sharp = false;
        for (Turn& t : turns) {
            if (t.fork || tree.fixed[t.at] || turn_cosine(tree, t) >= kSharp) continue;
            t.stiffness *= kStiffer;
            sharp = true;
        }
        if (!sharp) break;
    }
}

}  // namespace coppice::extract_internal
