#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "coppice/sketch/match_internal.h"

namespace coppice::sketch_internal {
namespace {

using Camera = Eigen::Matrix<double, 3, 4>;

constexpr std::size_t kSamples = 48;  // number of samples of each stroke
constexpr double kMaxCost = 12;       // maximum cost of a sample
constexpr double kUnmatchedCost = 2;  // cost of a sample at an end that only one stroke has

/// Numbers of samples by which a step advances along both strokes, and the cost of their ratio.
struct Step {
    std::size_t first, second;
    double cost;
};
constexpr std::array<Step, 9> kSteps{{{1, 1, 0},
                                      {2, 3, 0.35},
                                      {3, 2, 0.35},
                                      {1, 2, 1},
                                      {2, 1, 1},
                                      {1, 3, 2},
                                      {3, 1, 2},
                                      {0, 1, 2.5},
                                      {1, 0, 2.5}}};

Camera make_camera(const SketchView& view) {
    Eigen::Matrix3d k;
    Camera pose = Camera::Zero();
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            k(i, j) = view.k[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
            pose(i, j) = view.r[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
        }
        pose(i, 3) = view.t[i];
    }
    if (view.projection == Projection::orthographic) pose.row(2) << 0, 0, 0, 1;
    return k * pose;
}

/// The line a x + b y + c = 0 in an image.
struct PictureLine {
    Vec3d abc;
    double normal_squared;
};

PictureLine picture_line(Vec3d abc) { return {abc, abc.x * abc.x + abc.y * abc.y}; }

/// Returns the epipolar distance of two points, signed by the side of the epipolar line; `line_a` and
/// `line_b` are the epipolar lines of b and a.
double side_distance(const PictureLine& line_b, const PictureLine& line_a, PicturePoint b) {
    const double across = line_a.normal_squared + line_b.normal_squared;
    return (b.x * line_b.abc.x + b.y * line_b.abc.y + line_b.abc.z) / std::sqrt(std::max(across, 1e-300));
}

double side_distance(const Matrix3& f, PicturePoint first, PicturePoint second) {
    return side_distance(picture_line(f * Vec3d{first.x, first.y, 1}),
                         picture_line(transposed(f) * Vec3d{second.x, second.y, 1}), second);
}

/// Table of the cheapest paths to all pairs of samples.
class Table {
  public:
    Table(const Line& first, const Line& second, const Matrix3& f, bool starts_meet)
        : starts_meet_(starts_meet), noise_(compute_noise(first, second)) {
        weigh(first, second, f);
        for (std::size_t i = 0; i < kSamples; ++i)
            for (std::size_t j = 0; j < kSamples; ++j) reach(i, j);
    }

    Match best(const Line& first, const Line& second) const {
        std::size_t i = kSamples - 1, j = kSamples - 1;
        double least = total_[i][j];
        for (std::size_t n = 0; n + 1 < kSamples; ++n) {
            const double open = kUnmatchedCost * static_cast<double>(kSamples - 1 - n);
            if (total_[n][kSamples - 1] + open < least)
                least = total_[n][kSamples - 1] + open, i = n, j = kSamples - 1;
            if (total_[kSamples - 1][n] + open < least)
                least = total_[kSamples - 1][n] + open, i = kSamples - 1, j = n;
        }
        Match match;
        match.cost = least / kSamples;
        const auto pair = [&](std::size_t m, std::size_t n) {
            return Pair{first.length() * static_cast<double>(m) / (kSamples - 1),
                        second.length() * static_cast<double>(n) / (kSamples - 1)};
        };
        match.pairs.push_back(pair(i, j));
        const std::size_t last_i = i, last_j = j;
        for (int step = from_[i][j]; step >= 0; step = from_[i][j]) {
            i -= kSteps[static_cast<std::size_t>(step)].first;
            j -= kSteps[static_cast<std::size_t>(step)].second;
            match.pairs.push_back(pair(i, j));
        }
        std::ranges::reverse(match.pairs);
        match.share = static_cast<double>(std::min(last_i - i, last_j - j)) / (kSamples - 1);
        return match;
    }

  private:
    static double compute_noise(const Line& first, const Line& second) {
        return std::max(std::hypot(first.noise, second.noise) / std::sqrt(2.0), 1.0);
    }

    /// Returns the arc length [pixels] of the midpoint between samples i - 1 and i.
    static double before_sample(const Line& line, std::size_t i) {
        const double share = (static_cast<double>(i) - 0.5) / (kSamples - 1);
        return line.length() * std::clamp(share, 0.0, 1.0);
    }

    /// A sample represents the line up to the midpoints to its neighbours; its cost is the minimum over this
    /// interval.
    void weigh(const Line& first, const Line& second, const Matrix3& f) {
        const Matrix3 back = transposed(f);
        std::array<PicturePoint, kSamples + 1> b;
        std::array<PictureLine, kSamples + 1> line_a, line_b;
        for (std::size_t i = 0; i <= kSamples; ++i) {
            const PicturePoint a = first.at(before_sample(first, i));
            b[i] = second.at(before_sample(second, i));
            line_b[i] = picture_line(f * Vec3d{a.x, a.y, 1});
            line_a[i] = picture_line(back * Vec3d{b[i].x, b[i].y, 1});
        }
        std::array<std::array<double, kSamples + 1>, 2> side{};
        for (std::size_t i = 0; i <= kSamples; ++i) {
            for (std::size_t j = 0; j <= kSamples; ++j)
                side[i % 2][j] = side_distance(line_b[i], line_a[j], b[j]) / noise_;
            for (std::size_t j = 0; i > 0 && j < kSamples; ++j) {
                const double low = std::min({side[0][j], side[1][j], side[0][j + 1], side[1][j + 1]});
                const double high = std::max({side[0][j], side[1][j], side[0][j + 1], side[1][j + 1]});
                const double off = low > 0 ? low : high < 0 ? -high : 0;
                own_[i - 1][j] = std::min(0.5 * off * off, kMaxCost);
            }
        }
    }

    void reach(std::size_t i, std::size_t j) {
        const bool may_begin = starts_meet_ ? i + j == 0 : i == 0 || j == 0;
        total_[i][j] = may_begin ? own_[i][j] + kUnmatchedCost * static_cast<double>(i + j)
                                 : std::numeric_limits<double>::infinity();
        from_[i][j] = -1;
        for (std::size_t s = 0; s < kSteps.size(); ++s) {
            const Step& step = kSteps[s];
            if (step.first > i || step.second > j) continue;
            const double weight = 0.5 * static_cast<double>(step.first + step.second);
            const double cost = total_[i - step.first][j - step.second] + step.cost + weight * own_[i][j];
            if (cost < total_[i][j]) total_[i][j] = cost, from_[i][j] = static_cast<int>(s);
        }
    }

    bool starts_meet_;
    double noise_;  ///< [pixels] combined noise of both lines
    std::array<std::array<double, kSamples>, kSamples> own_, total_;
    std::array<std::array<int, kSamples>, kSamples> from_;
};

/// Moves the second points of pairs, by at most one sample, onto the epipolar lines of the first ones, except
/// where these are parallel to the stroke. The ends are fixed.
void refine(Match& match, const Line& first, const Line& second, const Matrix3& f) {
    const double sample = second.length() / (kSamples - 1), half = 0.5 * sample;
    for (std::size_t i = 1; i + 1 < match.pairs.size(); ++i) {
        Pair& pair = match.pairs[i];
        const PicturePoint a = first.at(pair.s);
        const double middle = pair.t;
        for (int step = 0; step < 2; ++step) {
            const double slope = (side_distance(f, a, second.at(pair.t + half)) -
                                  side_distance(f, a, second.at(pair.t - half))) /
                                 sample;
            const double off = side_distance(f, a, second.at(pair.t));
            const double give = second.noise / sample;
            pair.t -= off * slope / (slope * slope + give * give);
            pair.t = std::clamp(pair.t, middle - sample, middle + sample);
        }
    }
    for (std::size_t i = 1; i < match.pairs.size(); ++i)
        match.pairs[i].t = std::clamp(match.pairs[i].t, match.pairs[i - 1].t, match.pairs.back().t);
}

}  // namespace

// [Hartley2004] 17.3: valid for every pair of linear cameras, including orthographic ones, which have no
// centre.
Matrix3 fundamental_matrix(const SketchView& first, const SketchView& second) {
    const Camera a = make_camera(first), b = make_camera(second);
    Matrix3 f{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            Eigen::Matrix4d m;
            const auto others = [](std::size_t k) { return std::array{k == 0 ? 1 : 0, k == 2 ? 1 : 2}; };
            m << a.row(others(j)[0]), a.row(others(j)[1]), b.row(others(i)[0]), b.row(others(i)[1]);
            f[i][j] = ((i + j) % 2 == 0 ? 1 : -1) * m.determinant();
        }
    }
    return f;
}

double signed_epipolar_distance(const Matrix3& f, PicturePoint first, PicturePoint second) {
    return side_distance(f, first, second);
}

double epipolar_distance(const Matrix3& f, PicturePoint first, PicturePoint second) {
    return std::abs(side_distance(f, first, second));
}

Match match_lines(const Line& first, const Line& second, const Matrix3& f, bool starts_meet) {
    Match match = Table(first, second, f, starts_meet).best(first, second);
    refine(match, first, second, f);
    return match;
}

}  // namespace coppice::sketch_internal
