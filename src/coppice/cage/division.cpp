#include "coppice/cage/division_internal.h"

#include <algorithm>
#include <limits>
#include <numbers>

namespace coppice::cage_internal {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
// Number of sites that are placed with optimisation; the others are stacked around the second site.
constexpr std::size_t kMaxWeighed = 48;
// Number of ways to open a corner that are tried completely.
constexpr std::size_t kTried = 6;
// Weight of the shape of an opening relative to the deficit of the cells after it.
constexpr float kShape = 0.5f;
// Smoothing passes after each opening.
constexpr int kPasses = 3;
// Share of the distance to its target by which a corner moves.
constexpr float kStep = 0.7f;

Vec3 tangent(Vec3 at, Vec3 to) { return normalized(to - at * dot(at, to)); }

bool is_laid(const Division& d, std::size_t site) { return d.cell[site][0] != d.cell[site][1]; }

// Adds the target corners of a cell: a square around the site at their mean angle, but at least the angle of
// the site's cone. Small cells have a greater weight.
void add_square(const Ring& cell, const Site& site, std::span<const Vec3> corner, std::span<Vec3> wanted) {
    const Frame frame(site.direction);
    const Frame::Quarters mean =
        frame.compute_quarters([&](std::size_t k) { return corner[cell[k]]; }, Vec3{});
    const auto out = frame.quarters_from(normalized(frame.x * mean.x + frame.y * mean.y, frame.x));
    // Half an angle is the argument of the number (1 + cos) + i sin, and a product of such numbers adds their
    // halves: this needs one arctangent instead of four.
    constexpr float kTiny = 1e-6f;  // defines the angle of a corner opposite to the site
    float re = 1, im = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const float c = 1 + kTiny + dot(corner[cell[k]], site.direction), s = mean.off_axis[k];
        const float turned = re * c - im * s;
        im = re * s + im * c;
        re = turned;
    }
    const float twice = fast_atan2(im, re);
    const float angle = std::max(0.5f * (twice < 0 ? twice + 2 * kPi : twice), site.angle);
    const float w = 1 / (angle * angle), cosine = std::cos(angle), sine = std::sin(angle);
    for (std::size_t k = 0; k < 4; ++k) wanted[cell[k]] += (site.direction * cosine + out[k] * sine) * w;
}

// Returns the deficit of the cells relative to their cones; 0 if all cells contain their cones.
float lack(const Division& d, std::span<const Site> sites) {
    float sum = 0;
    for (std::size_t i = 0; i < sites.size(); ++i) {
        if (!is_laid(d, i)) continue;
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3 edge = cross(d.corner[d.cell[i][k]], d.corner[d.cell[i][(k + 1) % 4]]);
            const float inside =
                std::asin(std::clamp(dot(normalized(edge), sites[i].direction), -1.0f, 1.0f));
            const float missing = std::max(0.0f, 1 - inside / sites[i].angle);
            sum += missing * missing;
        }
    }
    return sum;
}

// A corner, two edges at it, and the cells from the first edge counter-clockwise to the second.
struct Opening {
    std::uint32_t corner, east, west;
    std::vector<std::uint32_t> north;
    Vec3 to_north;  ///< unit, at the new site
    float cost;
};

class Divider {
  public:
    Divider(std::span<const Site> sites, std::uint32_t first, std::uint32_t second) : sites_(sites) {
        d_.cell.resize(sites.size(), Ring{});
        const Frame frame(normalized(sites[second].direction - sites[first].direction,
                                     perpendicular(sites[first].direction)));
        std::vector<std::uint32_t> order;
        for (std::uint32_t i = 0; i < sites.size(); ++i) {
            if (i != first && i != second) order.push_back(i);
        }
        std::stable_sort(order.begin(), order.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return sites[a].angle > sites[b].angle; });
        const float start = order.empty() ? 0 : frame.azimuth(sites[order[0]].direction);
        const auto out = frame.quarters(start);
        d_.corner.reserve(sites.size() + 2);
        d_.corner.assign(out.begin(), out.end());
        d_.cell[second] = {0, 1, 2, 3};
        d_.cell[first] = {0, 3, 2, 1};
        laid_ = {first, second};
        for (const std::uint32_t i : order) {
            if (laid_.size() < kMaxWeighed) {
                insert(i);
            } else {
                stack(i, second);
            }
        }
    }
    Division take() && { return std::move(d_); }

  private:
    void insert(std::uint32_t site) {
        std::vector<Opening> ways = openings(site);
        const std::size_t tried = std::min(ways.size(), kTried);
        std::partial_sort(ways.begin(), ways.begin() + static_cast<std::ptrdiff_t>(tried), ways.end(),
                          [](const Opening& a, const Opening& b) { return a.cost < b.cost; });
        Division next, best;
        float least = std::numeric_limits<float>::max();
        for (std::size_t i = 0; i < tried; ++i) {
            next = d_;
            open(next, ways[i], site);
            even_out(next, sites_, kPasses);
            const float missing = lack(next, sites_) + kShape * ways[i].cost;
            if (i > 0 && !(missing < least)) continue;
            least = missing;
            std::swap(best, next);
        }
        std::swap(d_, best);
        laid_.push_back(site);
    }

    // Opens the corner of another site's cell that is closest to a site.
    void stack(std::uint32_t site, std::uint32_t upon) {
        const Ring ring = d_.cell[upon];
        std::size_t nearest = 0;
        for (std::size_t k = 1; k < 4; ++k) {
            if (dot(d_.corner[ring[k]], sites_[site].direction) >
                dot(d_.corner[ring[nearest]], sites_[site].direction))
                nearest = k;
        }
        const Vec3 d = sites_[site].direction;
        open(d_,
             {ring[nearest],
              ring[(nearest + 1) % 4],
              ring[(nearest + 3) % 4],
              {upon},
              tangent(d, sites_[upon].direction),
              0},
             site);
    }

    std::vector<Opening> openings(std::uint32_t site) const {
        // by corner: the cell, and the index of the corner in it
        std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> around(d_.corner.size());
        for (const std::uint32_t i : laid_) {
            for (std::uint32_t k = 0; k < 4; ++k) around[d_.cell[i][k]].push_back({i, k});
        }
        std::vector<Opening> ways;
        for (std::uint32_t v = 0; v < d_.corner.size(); ++v) {
            sort_around(around[v]);
            const auto& cells = around[v];
            for (std::size_t a = 0; a < cells.size(); ++a) {
                for (std::size_t b = a + 1; b < cells.size(); ++b) {
                    Opening way{v, find_edge(cells[a]), find_edge(cells[b]), {}, {}, 0};
                    for (std::size_t i = a; i < b; ++i) way.north.push_back(cells[i].first);
                    std::vector<std::uint32_t> south;
                    for (std::size_t i = b; i < cells.size() + a; ++i)
                        south.push_back(cells[i % cells.size()].first);
                    weigh(way, south, site);
                    ways.push_back(std::move(way));
                }
            }
        }
        return ways;
    }

    // Returns the corner that follows in the cell.
    std::uint32_t find_edge(std::pair<std::uint32_t, std::uint32_t> at) const {
        return d_.cell[at.first][(at.second + 1) % 4];
    }

    // Sorts counter-clockwise around the corner: each cell ends with the edge with which the next begins.
    void sort_around(std::vector<std::pair<std::uint32_t, std::uint32_t>>& cells) const {
        for (std::size_t i = 1; i < cells.size(); ++i) {
            const std::uint32_t last = d_.cell[cells[i - 1].first][(cells[i - 1].second + 3) % 4];
            for (std::size_t j = i; j < cells.size(); ++j) {
                if (find_edge(cells[j]) == last) {
                    std::swap(cells[i], cells[j]);
                    break;
                }
            }
        }
    }

    // Rates an opening. Good openings are close, their edges leave in opposite directions, and the cells to
    // either side are there.
    void weigh(Opening& way, std::span<const std::uint32_t> south, std::uint32_t site) const {
        const Vec3 d = sites_[site].direction;
        const Vec3 east = tangent(d, d_.corner[way.east]), west = tangent(d, d_.corner[way.west]);
        way.to_north = cross(d, normalized(east - west, perpendicular(d)));
        way.cost = angle_between(d_.corner[way.corner], d) + 1 + dot(east, west);
        const auto side = [&](std::uint32_t i) { return dot(tangent(d, sites_[i].direction), way.to_north); };
        for (const std::uint32_t i : way.north) way.cost += std::max(0.0f, -side(i));
        for (const std::uint32_t i : south) way.cost += std::max(0.0f, side(i));
    }

    void open(Division& next, const Opening& way, std::uint32_t site) const {
        const auto top = static_cast<std::uint32_t>(next.corner.size());
        for (const std::uint32_t i : way.north) {
            for (auto& c : next.cell[i]) c = c == way.corner ? top : c;
        }
        next.cell[site] = {way.east, top, way.west, way.corner};
        const Vec3 d = sites_[site].direction, off = way.to_north * std::tan(sites_[site].angle);
        next.corner.push_back(normalized(d + off));
        next.corner[way.corner] = normalized(d - off);
    }

    std::span<const Site> sites_;
    std::vector<std::uint32_t> laid_;
    Division d_;
};

}  // namespace

Division divide_sphere(std::span<const Site> sites, std::uint32_t first, std::uint32_t second) {
    return Divider(sites, first, second).take();
}

void even_out(Division& division, std::span<const Site> sites, int passes) {
    std::vector<Vec3> wanted(division.corner.size());
    for (int pass = 0; pass < passes; ++pass) {
        std::fill(wanted.begin(), wanted.end(), Vec3{});
        for (std::size_t i = 0; i < sites.size(); ++i) {
            if (is_laid(division, i)) add_square(division.cell[i], sites[i], division.corner, wanted);
        }
        for (std::size_t v = 0; v < wanted.size(); ++v) {
            Vec3& u = division.corner[v];
            u = normalized(u * (1 - kStep) + normalized(wanted[v], u) * kStep, u);
        }
    }
}

}  // namespace coppice::cage_internal
