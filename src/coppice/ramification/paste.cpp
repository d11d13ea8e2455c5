#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "coppice/base/id.h"
#include "coppice/ramification/objective_internal.h"
#include "coppice/ramification/paste_internal.h"
#include "coppice/subdivision/catmull_clark.h"

namespace coppice::ramification_internal {
namespace {

using Loop = std::array<std::uint32_t, 8>;
using Points = std::array<Vec3d, 8>;

// Search radius of the intersection of the axis with the mesh, in diameters about the joint.
constexpr double kReach = 1.5;
// [radii of the parent] A single face is used if it is closer than a vertex by more than this.
constexpr double kSingleFace = 0.25;
// A lateral narrower than this share of its place gets a band of quads about it.
constexpr double kNarrow = 0.75;
// Maximum share of a place used by the boundary of a lateral.
constexpr double kPlaceFilled = 0.8;

/// Returns the parameter of the intersection of a segment with a triangle [Moller1997].
std::optional<double> hit_triangle(Vec3d from, Vec3d way, Vec3d a, Vec3d b, Vec3d c) {
    const Vec3d ab = b - a, ac = c - a, p = cross(way, ac);
    const double det = dot(ab, p);
    if (det == 0) return {};
    const Vec3d s = from - a, q = cross(s, ab);
    const double u = dot(s, p) / det, v = dot(way, q) / det, t = dot(ac, q) / det;
    if (u < 0 || v < 0 || u + v > 1 || t < 0 || t > 1) return {};
    return t;
}

Vec3d compute_center(std::span<const Vec3d> points) {
    Vec3d sum;
    for (const Vec3d p : points) sum += p;
    return sum / static_cast<double>(points.size());
}

double compute_radius(std::span<const Vec3d> points, Vec3d center) {
    double sum = 0;
    for (const Vec3d p : points) sum += distance(p, center);
    return sum / static_cast<double>(points.size());
}

/// Returns the normal of a counter-clockwise loop.
Vec3d compute_normal(std::span<const Vec3d> points) {
    const Vec3d c = compute_center(points);
    Vec3d sum;
    for (std::size_t k = 0; k < points.size(); ++k)
        sum += cross(points[k] - c, points[(k + 1) % points.size()] - c);
    return normalized(sum);
}

}  // namespace

Subdivided::Subdivided(const MainMesh& main, const Context& ctx) : main_(main) {
    const ControlMesh& control = main.control;
    const auto vertices = static_cast<std::uint32_t>(control.cage.positions.size());
    const PatchRefinement patches(control.cage.quads, vertices, 1, ctx);
    positions_ = patches.refine(control.cage.positions, ctx);
    anchors_ = patches.refine(control.anchors, ctx);
    const Buffer<Quad> quads = patches.quads(ctx);
    quads_.assign(quads.begin(), quads.end());
    // The new vertices of an edge follow those of the cage.
    for (const Paste& paste : main.pastes) {
        Loop loop{};
        for (std::uint32_t k = 0; k < 4; ++k) {
            const std::uint32_t q = paste.first_of_tube + k;
            loop[2 * k] = control.cage.quads[q][0];
            loop[2 * k + 1] = vertices + (patches.cage().side[4 * q] >> 1);
        }
        boundary_.push_back(loop);
    }
}

/// Pastes laterals one after the other; deleted quads are marked and removed at the end.
class Paster {
  public:
    Paster(Subdivided& mesh, const Branches& branches, RamificationReport& report)
        : mesh_(mesh),
          branches_(branches),
          report_(report),
          gone_(mesh.quads_.size(), false),
          image_(mesh.positions_.size()) {
        for (std::uint32_t v = 0; v < image_.size(); ++v) image_[v] = v;
    }

    void fill(const Seat& seat) {
        load(seat);
        unit_ = mesh_.main_.control.region[seat.quads[0]];
        std::size_t left = seat.pastes.size();
        for (const std::uint32_t p : seat.pastes) paste(p, --left);
    }

    ControlMesh result() &&;

  private:
    struct Place {
        std::array<std::uint32_t, 4> faces{};
        std::uint32_t face_count = 0;
        std::vector<std::uint32_t> border;  ///< 8 vertices, or the 4 of a single face
        Vec3d center;
    };
    struct Corner {
        std::uint32_t vertex, face, corner;
    };

    Vec3d point(std::uint32_t v) const { return Vec3d(mesh_.positions_[v]); }
    template <class Vertices>
    std::vector<Vec3d> points(const Vertices& vertices) const {
        std::vector<Vec3d> out;
        for (const std::uint32_t v : vertices) out.push_back(point(v));
        return out;
    }

    /// Loads the faces of a seat, and the vertices with exactly four faces that are all among them.
    void load(const Seat& seat) {
        faces_.clear();
        places_.clear();
        std::vector<Corner> corners;
        for (const std::uint32_t q : seat.quads) {
            for (std::uint32_t f = 4 * q; f < 4 * q + 4; ++f) {
                faces_.push_back(f);
                for (std::uint32_t c = 0; c < 4; ++c) corners.push_back({mesh_.quads_[f][c], f, c});
            }
        }
        std::ranges::stable_sort(corners, {}, &Corner::vertex);
        for (std::size_t i = 0; i + 3 < corners.size();) {
            std::size_t end = i;
            while (end < corners.size() && corners[end].vertex == corners[i].vertex) ++end;
            if (end - i == 4) add_place(std::span(corners).subspan(i, 4));
            i = end;
        }
    }

    /// Adds a place about a vertex if the four corners surround it.
    void add_place(std::span<const Corner> corners) {
        Place place;
        place.center = point(corners[0].vertex);
        std::array<bool, 4> used{};
        std::size_t at = 0;
        for (std::uint32_t n = 0; n < 4; ++n) {
            if (used[at]) return;
            used[at] = true;
            const Quad& q = mesh_.quads_[corners[at].face];
            const std::uint32_t c = corners[at].corner;
            place.faces[n] = corners[at].face;
            place.border.push_back(q[(c + 1) & 3]);
            place.border.push_back(q[(c + 2) & 3]);
            const std::uint32_t across = q[(c + 3) & 3];
            std::size_t next = 0;
            while (next < 4 && mesh_.quads_[corners[next].face][(corners[next].corner + 1) & 3] != across)
                ++next;
            if (next == 4) return;
            at = next;
        }
        if (at != 0) return;
        place.face_count = 4;
        places_.push_back(std::move(place));
    }

    bool is_free(const Place& place) const {
        for (std::uint32_t i = 0; i < place.face_count; ++i) {
            if (gone_[place.faces[i]]) return false;
        }
        return true;
    }

    Place single(std::uint32_t face) const {
        Place place;
        place.faces[0] = face;
        place.face_count = 1;
        place.border.assign(mesh_.quads_[face].begin(), mesh_.quads_[face].end());
        place.center = compute_center(points(place.border));
        return place;
    }

    /// Returns the intersection of the axis of the lateral with the faces of the seat, within a ball about
    /// the joint; otherwise its exit from the cone.
    Vec3d hit(const Paste& paste) const {
        const Path own = branches_.path(paste.lateral.branch);
        const Vec3d joint = own.position(0);
        const double reach = std::max(kReach * paste.diameter, 1.2 * distance(joint, paste.lateral.exit));
        double nearest = std::numeric_limits<double>::infinity();
        Vec3d found = paste.lateral.exit;
        for (std::uint32_t s = 0; s < own.segment_count() && own.arc(s) < reach; ++s) {
            const Vec3d a = own.position(own.arc(s)), way = own.position(own.arc(s + 1)) - a;
            for (const std::uint32_t f : faces_) {
                const Quad& q = mesh_.quads_[f];
                for (const int half : {1, 2}) {
                    const auto t = hit_triangle(a, way, point(q[0]), point(q[half]), point(q[half + 1]));
                    if (!t) continue;
                    const double arc = own.arc(s) + *t * length(way);
                    const double off = std::abs(arc - paste.lateral.exit_arc);
                    if (off < nearest && distance(a + way * *t, joint) < reach) {
                        nearest = off;
                        found = a + way * *t;
                    }
                }
            }
        }
        return found;
    }

    /// Returns the free place closest to a point: about a vertex, or a single face if that is much closer, or
    /// if the faces would not suffice for the remaining laterals. There is always one: a unit has two faces
    /// for each of its laterals, and four are used for one only if the remaining laterals have one each.
    Place next_to(Vec3d p, double radius, std::size_t left) const {
        double best = std::numeric_limits<double>::infinity();
        const Place* about_vertex = nullptr;
        std::uint32_t nearest_face = faces_.front();
        std::size_t free = 0;
        for (const std::uint32_t f : faces_) free += gone_[f] ? 0 : 1;
        if (free >= left + 4) {
            for (const Place& place : places_) {
                const double d = distance(place.center, p);
                if (d >= best || !is_free(place)) continue;
                best = d;
                about_vertex = &place;
            }
        }
        bool face_wins = false;
        for (const std::uint32_t f : faces_) {
            if (gone_[f]) continue;
            const Quad& q = mesh_.quads_[f];
            const Vec3d center = (point(q[0]) + point(q[1]) + point(q[2]) + point(q[3])) / 4.0;
            const double d = distance(center, p) + kSingleFace * radius;
            if (d >= best) continue;
            best = d;
            nearest_face = f;
            face_wins = true;
        }
        return face_wins ? single(nearest_face) : *about_vertex;
    }

    void paste(std::uint32_t index, std::size_t left) {
        const Paste& paste = mesh_.main_.pastes[index];
        for (std::uint32_t q = paste.first_quad; q < paste.first_quad + paste.quad_count; ++q) {
            for (std::uint32_t f = 4 * q; f < 4 * q + 4; ++f) gone_[f] = true;
        }
        const Place place = next_to(hit(paste), paste.diameter / 2, left);
        for (std::uint32_t i = 0; i < place.face_count; ++i) gone_[place.faces[i]] = true;
        const Loop& sub = mesh_.boundary_[index];
        // Four corners are extended to eight by the midpoints of the sides.
        std::vector<Vec3d> around = points(place.border);
        if (around.size() == 4) {
            std::vector<Vec3d> eight;
            for (std::size_t k = 0; k < 4; ++k) {
                eight.push_back(around[k]);
                eight.push_back((around[k] + around[(k + 1) % 4]) / 2.0);
            }
            around = eight;
            ++report_.crowded;
        }
        std::vector<Vec3d> own = points(sub);
        report_.before.pastes += paste_distortion(own, around, paste.diameter);
        const std::uint32_t turn = best_turn(around, own, compute_normal(around));
        std::rotate(own.begin(), own.begin() + turn, own.end());
        Loop turned = sub;
        std::rotate(turned.begin(), turned.begin() + turn, turned.end());
        const Vec3d center = compute_center(around);
        const double room = compute_radius(around, center), wide = compute_radius(own, compute_center(own));
        const bool band = place.face_count == 1 || wide < kNarrow * room;
        const Vec3d before = compute_center(own);
        move_into(own, center, room, band);
        const Vec3 shift(compute_center(own) - before);
        report_.after.pastes += paste_distortion(own, around, paste.diameter);
        for (std::size_t k = 0; k < 8; ++k) {
            mesh_.positions_[turned[k]] = Vec3(own[k]);
            mesh_.anchors_[turned[k]] += shift;
        }
        if (place.face_count == 1) {
            fill_face(place.border, turned);
        } else if (band) {
            for (std::size_t k = 0; k < 8; ++k) {
                const std::size_t n = (k + 1) % 8;
                add_quad({place.border[k], place.border[n], turned[n], turned[k]});
            }
        } else {
            merge(place.border, turned);
        }
    }

    /// Moves a boundary to its place by the minimum that keeps it inside; scales it down if it is too wide
    /// for a band.
    static void move_into(std::vector<Vec3d>& own, Vec3d center, double room, bool band) {
        const Vec3d from = compute_center(own);
        const double wide = compute_radius(own, from);
        const double scale = band ? std::min(1.0, kPlaceFilled * room / wide) : 1.0;
        const double slack = std::max(0.0, kPlaceFilled * room - scale * wide), off = distance(from, center);
        const Vec3d to = off > slack ? center + (from - center) * (slack / off) : from;
        for (Vec3d& p : own) p = to + (p - from) * scale;
    }

    void add_quad(const Quad& q) {
        mesh_.quads_.push_back(q);
        mesh_.pasted_.push_back(unit_);
        gone_.push_back(false);
    }

    /// Adds six quads between a face and a loop of eight: one at each side, two at opposite corners.
    void fill_face(const std::vector<std::uint32_t>& a, const Loop& s) {
        add_quad({a[0], s[1], s[0], s[7]});
        add_quad({a[0], a[1], s[2], s[1]});
        add_quad({a[1], a[2], s[3], s[2]});
        add_quad({a[2], s[5], s[4], s[3]});
        add_quad({a[2], a[3], s[6], s[5]});
        add_quad({a[3], a[0], s[7], s[6]});
    }

    /// Merges the loops at the mean of their positions.
    void merge(const std::vector<std::uint32_t>& place, const Loop& sub) {
        for (std::size_t k = 0; k < 8; ++k) {
            const std::uint32_t p = place[k];
            mesh_.positions_[p] = (mesh_.positions_[p] + mesh_.positions_[sub[k]]) * 0.5f;
            mesh_.anchors_[p] = (mesh_.anchors_[p] + mesh_.anchors_[sub[k]]) * 0.5f;
            image_[sub[k]] = p;
        }
    }

    Subdivided& mesh_;
    const Branches& branches_;
    RamificationReport& report_;
    std::vector<bool> gone_;
    std::vector<std::uint32_t> image_;  ///< per vertex: the one that it was merged into
    std::uint32_t unit_ = 0;            ///< unit that is currently filled
    std::vector<std::uint32_t> faces_;
    std::vector<Place> places_;
};

ControlMesh Paster::result() && {
    const ControlMesh& main = mesh_.main_.control;
    ControlMesh out;
    out.cage.origin = main.cage.origin;
    std::vector<std::uint32_t> number(mesh_.positions_.size(), kNoIndex);
    const auto vertex = [&](std::uint32_t v) {
        v = image_[v];
        if (number[v] == kNoIndex) {
            number[v] = static_cast<std::uint32_t>(out.anchors.size());
            out.cage.positions.push_back(mesh_.positions_[v]);
            out.anchors.push_back(mesh_.anchors_[v]);
        }
        return number[v];
    };
    const auto put = [&](std::uint32_t f, TubeFace part, std::uint32_t region) {
        if (gone_[f]) return;
        const Quad& q = mesh_.quads_[f];
        out.cage.quads.push_back({vertex(q[0]), vertex(q[1]), vertex(q[2]), vertex(q[3])});
        out.part.push_back(part);
        out.region.push_back(region);
    };
    const auto count = static_cast<std::uint32_t>(main.cage.quads.size());
    auto clip = main.clip.begin();
    std::size_t pasted = 0;
    for (std::uint32_t q = 0; q < count;) {
        if (clip != main.clip.end() && q == clip->first_quad) {
            out.clip.push_back(*clip++);
            out.clip.back().first_quad = static_cast<std::uint32_t>(out.cage.quads.size());
            out.clip.back().quad_count *= 4;
        }
        const std::uint32_t region = main.region[q];
        if (main.part[q] == TubeFace::side) {
            // First the lower two quads of each of the four, then the upper two.
            for (const std::uint32_t row : {0u, 1u}) {
                for (std::uint32_t k = 0; k < 8; ++k)
                    put(4 * (q + k / 2) + 2 * row + k % 2, TubeFace::side, region + row);
            }
            q += 4;
            continue;
        }
        for (std::uint32_t k = 0; k < 4; ++k) put(4 * q + k, main.part[q], region);
        const bool is_last = ++q == count || main.part[q] != TubeFace::fork || main.region[q] != region;
        while (is_last && pasted < mesh_.pasted_.size() && mesh_.pasted_[pasted] == region)
            put(4 * count + static_cast<std::uint32_t>(pasted++), TubeFace::fork, region);
    }
    return out;
}

ControlMesh Subdivided::paste(const Branches& branches, RamificationReport& report, const Context& ctx) && {
    constexpr std::size_t kPoll = 256;
    Paster paster(*this, branches, report);
    for (std::size_t i = 0; i < main_.seats.size(); ++i) {
        if (i % kPoll == 0) ctx.throw_if_cancelled();
        paster.fill(main_.seats[i]);
    }
    return std::move(paster).result();
}

}  // namespace coppice::ramification_internal
