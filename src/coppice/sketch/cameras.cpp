#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "coppice/base/median.h"
#include "coppice/sketch/cameras_internal.h"
#include "coppice/sketch/fit_internal.h"
#include "coppice/sketch/match_internal.h"

namespace coppice::sketch_internal {
namespace {

constexpr int kSteps = 15;
constexpr double kUsualTurn = 0.02, kUsualMove = 0.01;
constexpr double kUsualScale = 0.01;  // standard deviations: [rad], [distance], relative
constexpr double kSmall = 1e-4;       // [standard deviation] step of finite differences
constexpr std::size_t kMin = 8;       // minimum number of points; with fewer, cameras are not changed

// change of a camera in standard deviations: rotation, translation, scale
using Change = Eigen::Matrix<double, 7, 1>;

/// The same point in two images.
struct Both {
    PicturePoint first, second;
};

/// Returns the view rotated about the centre of the scene, which keeps its position in the image, and then
/// moved and scaled.
SketchView changed(SketchView view, const Change& change, double away) {
    const Matrix3 turn = rotation_about(Vec3d{change[0], change[1], change[2]} * kUsualTurn);
    const Vec3d middle{0, 0, view.projection == Projection::perspective ? away : 0};
    view.r = turn * view.r;
    view.t = turn * (view.t - middle) + middle + Vec3d{change[3], change[4], change[5]} * (kUsualMove * away);
    const double scale = std::exp(kUsualScale * change[6]);
    view.k[0][0] *= scale;
    view.k[0][1] *= scale;
    view.k[1][1] *= scale;
    return view;
}

class Refiner {
  public:
    Refiner(const SketchView& first, const SketchView& second, std::vector<Both> places, double away,
            double noise)
        : first_(first), second_(second), places_(std::move(places)), away_(away), noise_(noise) {}

    SketchView run() const {
        Change now = Change::Zero();
        for (int step = 0; step < kSteps; ++step) now += step_from(now);
        return changed(second_, now, away_);
    }

  private:
    /// Returns the signed epipolar distance [pixels] of every point.
    Eigen::VectorXd off(const Change& change) const {
        const Matrix3 f = fundamental_matrix(first_, changed(second_, change, away_));
        Eigen::VectorXd out(static_cast<Eigen::Index>(places_.size()));
        for (std::size_t i = 0; i < places_.size(); ++i)
            out[static_cast<Eigen::Index>(i)] =
                signed_epipolar_distance(f, places_[i].first, places_[i].second);
        return out;
    }

    Change step_from(const Change& now) const {
        const Eigen::VectorXd here = off(now);
        Eigen::Matrix<double, Eigen::Dynamic, 7> slope(here.size(), 7);
        for (int c = 0; c < 7; ++c) {
            Change changed = now;
            changed[c] += kSmall;
            slope.col(c) = (off(changed) - here) / kSmall;
        }
        // The robust scale is the median distance, so that outliers do not count even if all distances are
        // large at first.
        std::vector<double> sizes(here.data(), here.data() + here.size());
        for (double& size : sizes) size = std::abs(size);
        const double usual = std::max(median_in_place(sizes) / 0.674, noise_);
        const Eigen::ArrayXd share = 1 / (1 + (here.array() / (3 * usual)).square());
        const Eigen::VectorXd weight = (share * share / (usual * usual)).matrix();
        Eigen::Matrix<double, 7, 7> system = slope.transpose() * weight.asDiagonal() * slope;
        system.diagonal().array() += 1;
        const Change down = slope.transpose() * weight.asDiagonal() * here + now;
        return -system.llt().solve(down);
    }

    const SketchView& first_;
    const SketchView& second_;
    std::vector<Both> places_;
    double away_, noise_;
};

/// Returns the starts and tips that both views show.
std::vector<Both> find_places(const Sketch& sketch, std::uint32_t first, std::uint32_t second) {
    std::vector<Both> out;
    for (const SketchBranch& branch : sketch.branches) {
        const Stroke* strokes[2] = {nullptr, nullptr};
        for (const Stroke& stroke : branch.strokes) {
            if (stroke.view == first) strokes[0] = &stroke;
            if (stroke.view == second) strokes[1] = &stroke;
        }
        if (strokes[0] == nullptr || strokes[1] == nullptr) continue;
        const auto seen = [&](const Stroke& stroke, PicturePoint p) {
            return undistorted(sketch.views[stroke.view], p);
        };
        out.push_back(
            {seen(*strokes[0], strokes[0]->points.front()), seen(*strokes[1], strokes[1]->points.front())});
        out.push_back(
            {seen(*strokes[0], strokes[0]->points.back()), seen(*strokes[1], strokes[1]->points.back())});
    }
    return out;
}

/// Returns the median depth [m] of the points from the second camera.
double compute_distance(const SketchView& first, const SketchView& second, const std::vector<Both>& places) {
    std::vector<double> depths;
    for (const Both& both : places)
        if (const auto p = meet(ray(first, both.first), ray(second, both.second)))
            depths.push_back(std::abs(depth(second, *p)));
    return depths.empty() ? 1 : median_in_place(depths);
}

}  // namespace

void refine_cameras(const Sketch& sketch, std::span<SketchView> views, const Hand& hand, const Context& ctx) {
    for (std::uint32_t v = 1; v < views.size(); ++v) {
        ctx.throw_if_cancelled();
        std::vector<Both> places = find_places(sketch, 0, v);
        if (places.size() < kMin) continue;
        const double away = compute_distance(views[0], views[v], places);
        views[v] = Refiner(views[0], views[v], std::move(places), away, hand.noise).run();
    }
}

}  // namespace coppice::sketch_internal
