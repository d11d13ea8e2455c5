#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/base/median.h"
#include "coppice/sketch/branch_internal.h"
#include "coppice/sketch/fit_internal.h"
#include "coppice/sketch/match_internal.h"

namespace coppice::sketch_internal {
namespace {

constexpr double kMostCost = 3;         // of a match, above which strokes are of different things
constexpr double kLeastMatched = 0.3;   // of the strokes
constexpr double kHopeless = 1e6;       // odd
constexpr double kOdd = 1.5;            // cost per node: twice what it usually is
constexpr double kLeap = 4;             // [pixels] that are as odd as 1
constexpr double kUsualPiece = 1.8;     // of the median piece between two points
constexpr double kFarBetter = 0.8;      // of how odd it was before
constexpr std::size_t kMostTried = 40;  // points of all strokes, of which each is tried
constexpr double kStartSlack = 2;  // [pixels] a stroke that begins so near its parent's axis begins on it
constexpr double kGuessedStart = 0.6, kGuessedEnd = 0.3;  // of the parent's radius

std::string rounded(double number, int digits) {
    std::string text = std::to_string(number);
    return text.substr(0, text.find('.') + (digits > 0 ? 1 + static_cast<std::size_t>(digits) : 0));
}

/// [rad] between the two lines of sight, whichever way they run.
double angle_of(const ViewRay& a, const ViewRay& b) {
    const double angle = angle_between(a, b);
    return std::min(angle, std::numbers::pi - angle);
}

/// The axis as a picture shows it.
Line shown_in(const SketchView& view, const Axis& axis) {
    std::vector<PicturePoint> points;
    for (const Vec3d p : axis.positions) points.push_back(project(view, p));
    return line_through(std::move(points));
}

class BranchMaker {
  public:
    BranchMaker(const Sketch& sketch, std::span<const SketchView> views, std::uint32_t branch,
                const Axis* parent, const SketchOptions& options, BranchFit& fit)
        : sketch_(sketch),
          views_(views),
          branch_(sketch.branches[branch]),
          parent_(parent),
          options_(options),
          fit_(fit) {}

    Axis run(const Context& ctx) {
        if (parent_ && parent_->positions.empty()) return refuse("the branch that it grows from was refused");
        if (branch_.strokes.size() < 2) return refuse("it is drawn in one view alone");
        std::vector<Line> drawn = lines_of(true);
        for (std::size_t i = 0; i < drawn.size(); ++i) {
            if (drawn[i].points.size() < 2)
                return refuse("all points of its stroke in '" + view_name(i) + "' lie in one place");
        }
        Outcome best = attempt(drawn, ctx);
        if (best.odd > kOdd && total_left_out(drawn) > 0) keep_better(best, drawn, lines_of(false), ctx);
        if (best.odd > kOdd && parent_ && !branch_.attach) look_for_start(best, drawn, ctx);
        while (best.odd > kOdd && leave_out_one(drawn, best, ctx)) {
        }
        fit_ = best.fit;
        return best.why.empty() ? best.axis : refuse(best.why);
    }

  private:
    const SketchView& view(std::size_t i) const { return views_[branch_.strokes[i].view]; }
    const std::string& view_name(std::size_t i) const { return view(i).name; }

    Axis refuse(const std::string& why) {
        std::string strokes;
        for (std::size_t i = 0; i < branch_.strokes.size(); ++i)
            strokes += (i == 0 ? "'" : ", '") + view_name(i) + "'";
        fit_.refused =
            "branch '" + branch_.name + "' (" + (strokes.empty() ? "no strokes" : "strokes in " + strokes);
        if (fit_.angle > 0)
            fit_.refused += ", " + rounded(fit_.angle * 180 / std::numbers::pi, 1) + " degrees apart";
        fit_.refused += ") is refused: " + why;
        return {};
    }

    /// What came of some lines.
    struct Outcome {
        Axis axis;
        BranchFit fit;
        std::string why;  ///< it is refused; or empty
        double odd = 0;   ///< above kOdd where some point may be wrong
    };

    std::vector<Line> lines_of(bool clean) const {
        std::vector<Line> out;
        for (const Stroke& stroke : branch_.strokes)
            out.push_back(line_of(sketch_.views[stroke.view], stroke, double{options_.noise}, clean));
        return out;
    }

    static std::size_t total_left_out(const std::vector<Line>& lines) {
        std::size_t sum = 0;
        for (const Line& line : lines) sum += line.left_out;
        return sum;
    }

    /// Tries these lines, and goes on with them where that is far better.
    bool keep_better(Outcome& best, std::vector<Line>& drawn, std::vector<Line> others, const Context& ctx) {
        Outcome tried = attempt(others, ctx);
        if (tried.odd > kFarBetter * best.odd) return false;
        best = std::move(tried);
        drawn = std::move(others);
        return true;
    }

    /// Strokes that lack much of their start say badly where they leave: what of them can be matched without
    /// knowing that says it better.
    void look_for_start(Outcome& best, std::vector<Line>& drawn, const Context& ctx) {
        lines_ = drawn;
        const auto [i, j] = pair_;
        const Match match = match_lines(lines_[i], lines_[j], fundamental_matrix(view(i), view(j)), false);
        if (!matches(match)) return;
        const Axis* parent = std::exchange(parent_, nullptr);
        double cost = 0;
        const std::vector<AxisNode> nodes = fit(match, cost, ctx);
        parent_ = parent;
        if (nodes.size() < 2) return;
        Axis axis;
        for (const AxisNode& node : nodes) axis.positions.push_back(node.position);
        std::vector<Line> shown;
        for (std::size_t k = 0; k < drawn.size(); ++k) shown.push_back(shown_in(view(k), axis));
        known_start_ = place_on(*parent_, views_, branch_.strokes, shown);
        if (!keep_better(best, drawn, drawn, ctx)) known_start_.reset();
    }

    Outcome attempt(const std::vector<Line>& drawn, const Context& ctx) {
        lines_ = drawn;
        fit_ = {.branch = fit_.branch};
        for (std::size_t i = 0; i < drawn.size(); ++i) {
            const Stroke& stroke = branch_.strokes[i];
            fit_.strokes.push_back({.view = stroke.view,
                                    .points = static_cast<std::uint32_t>(stroke.points.size()),
                                    .left_out = static_cast<std::uint32_t>(drawn[i].left_out)});
        }
        Outcome out;
        out.axis = made(out, ctx);
        out.fit = fit_;
        return out;
    }

    Axis made(Outcome& out, const Context& ctx) {
        choose_pair();
        if (fit_.angle < double{options_.least_angle})
            return out.why = "its views are too near to each other", Axis{};
        if (parent_) find_start();
        const Match match = matched();
        fit_.matched = match.share;
        out.odd = kHopeless * (1 + match.cost);
        if (!matches(match)) {
            out.why = "its strokes do not match: their points do not lie on each other's lines of sight";
            return {};
        }
        double cost = 0;
        Axis axis = fitted(match, cost, ctx);
        if (axis.positions.size() < 2) return out.why = "its lines of sight meet behind a camera", Axis{};
        measure_errors(axis);
        double error = 0;
        for (const StrokeFit& stroke : fit_.strokes) error = std::max(error, stroke.rms_error);
        if (error > double{options_.max_error}) {
            out.why =
                "no branch lies near all of its strokes, the best is off by " + rounded(error, 1) + " pixels";
        }
        const double noise = std::max(lines_[pair_[0]].noise, lines_[pair_[1]].noise);
        out.odd = cost * std::min(noise * noise, 1.0);
        if (match.pairs.back().s < 0.95 * lines_[pair_[0]].length() ||
            match.pairs.back().t < 0.95 * lines_[pair_[1]].length())
            out.odd += std::max(leap_of(0), leap_of(1)) / kLeap;
        return axis;
    }

    /// [pixels] by which the last piece of a stroke of the pair is longer than is usual.
    double leap_of(std::size_t which) const {
        const Line& line = lines_[pair_[which]];
        const std::size_t last = line.points.size() - 1;
        std::vector<double> pieces;
        for (const std::size_t i : pair_)
            for (std::size_t p = 1; p < lines_[i].points.size(); ++p)
                if (&lines_[i] != &line || p != last)
                    pieces.push_back(lines_[i].along[p] - lines_[i].along[p - 1]);
        return std::max(line.along[last] - line.along[last - 1] - kUsualPiece * median(pieces), 0.0);
    }

    /// Tries what comes of the strokes without each of their points, and keeps the best where that is far
    /// better: of few points none can be told to be wrong by its own stroke.
    bool leave_out_one(std::vector<Line>& drawn, Outcome& best, const Context& ctx) {
        std::size_t points = 0;
        for (const Line& line : drawn) points += line.points.size();
        if (points > kMostTried || total_left_out(drawn) > points / 4) return false;
        const Outcome before = best;
        std::vector<Line> kept = drawn;
        for (std::size_t i = 0; i < drawn.size(); ++i) {
            if (drawn[i].points.size() <= 2) continue;
            for (std::size_t p = 0; p < drawn[i].points.size(); ++p) {
                std::vector<Line> without = drawn;
                without[i] = without_point(drawn[i], p);
                Outcome tried = attempt(without, ctx);
                if (tried.odd < best.odd && tried.odd < kFarBetter * before.odd)
                    best = std::move(tried), kept = std::move(without);
            }
        }
        drawn = std::move(kept);
        return best.odd < before.odd;
    }

    /// The two views that differ most.
    void choose_pair() {
        const auto sight = [&](std::size_t i) {
            return ray(view(i), lines_[i].at(0.5 * lines_[i].length()));
        };
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            for (std::size_t j = i + 1; j < lines_.size(); ++j) {
                const double angle = angle_of(sight(i), sight(j));
                if (angle > fit_.angle) fit_.angle = angle, pair_ = {i, j};
            }
        }
    }

    /// Turns strokes that end on the parent's axis and begin off it; finds the place on it where they begin.
    void find_start() {
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            const Line shown = shown_in(view(i), *parent_);
            const auto off = [&](PicturePoint p) {
                return length(p - shown.at(shown.nearest(p, 0, shown.length())));
            };
            const double start = off(lines_[i].points.front()), end = off(lines_[i].points.back());
            if (start > 10 && end < 0.3 * start) turn(i);
        }
        start_ = branch_.attach ? place_at(*branch_.attach)
                 : known_start_ ? *known_start_
                                : place_on(*parent_, views_, branch_.strokes, lines_);
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            const PicturePoint p = project(view(i), parent_->at(start_));
            if (length(p - lines_[i].points.front()) > kStartSlack) lines_[i] = with_start(lines_[i], p);
        }
    }

    void turn(std::size_t i) {
        lines_[i] = reversed(lines_[i]);
        fit_.strokes[i].reversed = !fit_.strokes[i].reversed;
    }

    Place place_at(double share) const {
        const auto& p = parent_->positions;
        double total = 0, before = 0;
        for (std::size_t i = 0; i + 1 < p.size(); ++i) total += distance(p[i], p[i + 1]);
        for (std::size_t i = 0; i + 1 < p.size(); ++i) {
            const double piece = distance(p[i], p[i + 1]);
            if (before + piece >= share * total)
                return {i, std::clamp((share * total - before) / std::max(piece, 1e-12), 0.0, 1.0)};
            before += piece;
        }
        return {p.size() - 2, 1};
    }

    static bool matches(const Match& match) {
        return match.cost <= kMostCost && match.share >= kLeastMatched;
    }

    Match matched() {
        const auto [i, j] = pair_;
        const Matrix3 f = fundamental_matrix(view(i), view(j));
        Match match = match_lines(lines_[i], lines_[j], f, parent_ != nullptr);
        if (match.cost <= kMostCost || parent_) return match;
        // A stem that was drawn downwards in one view.
        Match turned = match_lines(lines_[i], reversed(lines_[j]), f, false);
        if (turned.cost > 0.5 * match.cost) return match;
        turn(j);
        return turned;
    }

    std::vector<AxisNode> fit(const Match& match, double& cost, const Context& ctx) const {
        std::vector<Sight> others;
        for (std::size_t i = 0; i < lines_.size(); ++i)
            if (i != pair_[0] && i != pair_[1]) others.push_back({&view(i), &lines_[i]});
        const auto [i, j] = pair_;
        FitInput input{.matched = {Sight{&view(i), &lines_[i]}, Sight{&view(j), &lines_[j]}},
                       .others = others,
                       .match = &match,
                       .start = {},
                       .bend = double{options_.bend}};
        if (parent_) input.start = parent_->at(start_);
        FittedAxis found = fit_axis(input, ctx);
        cost = found.cost;
        return std::move(found.nodes);
    }

    Axis fitted(const Match& match, double& cost, const Context& ctx) {
        const std::vector<AxisNode> nodes = fit(match, cost, ctx);
        Axis axis;
        axis.start = start_;
        for (const AxisNode& node : nodes) axis.positions.push_back(node.position);
        if (nodes.size() >= 2) set_radii(nodes, axis);
        return axis;
    }

    void set_radii(const std::vector<AxisNode>& nodes, Axis& axis) {
        const bool drawn = std::ranges::any_of(lines_, [](const Line& l) { return !l.widths.empty(); });
        std::vector<double> along(1, 0);
        for (std::size_t i = 1; i < nodes.size(); ++i)
            along.push_back(along.back() + distance(nodes[i - 1].position, nodes[i].position));
        fit_.length = along.back();
        const auto between = [&](double first, double last) {
            for (const double s : along)
                axis.radii.push_back(std::lerp(first, last, s / std::max(along.back(), 1e-300)));
        };
        if (branch_.diameters) return between(0.5 * (*branch_.diameters)[0], 0.5 * (*branch_.diameters)[1]);
        if (drawn) {
            for (const AxisNode& node : nodes) axis.radii.push_back(drawn_radius(node));
            return;
        }
        COPPICE_ASSERT(parent_ != nullptr);  // reconstruct looked
        fit_.guessed_radius = true;
        const double thick = parent_->radius_at(start_);
        between(kGuessedStart * thick, kGuessedEnd * thick);
    }

    /// The mean of what the strokes say: of the pair where they are matched, or else of all where they are
    /// nearest.
    double drawn_radius(const AxisNode& node) const {
        double sum = 0;
        int count = 0;
        const auto add = [&](std::size_t i, double s) {
            sum += 0.5 * lines_[i].width_at(s) / pixels_per_metre(view(i), node.position);
            ++count;
        };
        for (const std::size_t which : {std::size_t{0}, std::size_t{1}})
            if (!lines_[pair_[which]].widths.empty() && !std::isnan(node.along[which]))
                add(pair_[which], node.along[which]);
        for (std::size_t i = 0; count == 0 && i < lines_.size(); ++i) {
            const Line& line = lines_[i];
            if (!line.widths.empty()) add(i, line.nearest(project(view(i), node.position), 0, line.length()));
        }
        return sum / count;
    }

    void measure_errors(const Axis& axis) {
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            const Line line = shown_in(view(i), axis);
            double sum = 0;
            StrokeFit& fit = fit_.strokes[i];
            for (const PicturePoint p : lines_[i].points) {
                const double off = length(p - line.at(line.nearest(p, 0, line.length())));
                sum += off * off;
                fit.max_error = std::max(fit.max_error, off);
            }
            fit.rms_error = std::sqrt(sum / static_cast<double>(lines_[i].points.size()));
        }
    }

    const Sketch& sketch_;
    std::span<const SketchView> views_;
    const SketchBranch& branch_;
    const Axis* parent_;
    const SketchOptions& options_;
    BranchFit& fit_;
    std::vector<Line> lines_;  ///< one for each stroke
    std::array<std::size_t, 2> pair_{0, 1};
    Place start_;
    std::optional<Place> known_start_;  ///< that goes before what strokes say by themselves
};

}  // namespace

Axis make_axis(const Sketch& sketch, std::span<const SketchView> views, std::uint32_t branch,
               const Axis* parent, const SketchOptions& options, BranchFit& fit, const Context& ctx) {
    return BranchMaker(sketch, views, branch, parent, options, fit).run(ctx);
}

}  // namespace coppice::sketch_internal
