#include "coppice/pipeline/carry/sound_frames.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace coppice {
namespace {

constexpr std::uint32_t kRounds = 12;
constexpr int kPatience = 7;  // answers after which what is held grows by itself

// Marks what moves the faces that are at fault.
void hold_faults(const CarriedMesh& mesh, const CarriedFrame& frame, std::span<std::uint8_t> is_held) {
    for (const std::uint32_t f : frame.folded) mesh.mark_movers(f, is_held);
    for (const FacePair& p : frame.crossings) {
        mesh.mark_movers(p.first, is_held);
        mesh.mark_movers(p.second, is_held);
        hold_between(mesh.skeleton(), mesh.mover(p.first), mesh.mover(p.second), is_held);
    }
}

// The neighbours of all that is held, for what holding that has not helped.
void hold_more(const Skeleton& s, std::span<std::uint8_t> is_held) {
    const std::vector<std::uint8_t> before(is_held.begin(), is_held.end());
    for (const NodeId n : nodes(s)) {
        const NodeId parent = s.parent(n);
        if (!parent) continue;
        if (before[n.index()] != 0) is_held[parent.index()] = 1;
        if (before[parent.index()] != 0) is_held[n.index()] = 1;
    }
}

using Vertices = std::vector<std::uint32_t>;

template <class Operation>
Vertices combined(const Operation& operation, const Vertices& a, const Vertices& b) {
    Vertices out;
    operation(a, b, std::back_inserter(out));
    return out;
}

// What is done about the faults of one frame, round by round.
class Remedy {
  public:
    Remedy(const CarriedMesh& mesh, const Vertices& last_stiff)
        : mesh_(mesh), last_stiff_(last_stiff), is_held_(mesh.skeleton().size()) {}

    void answer(const CarriedFrame& frame) {
        const Vertices bad = mesh_.at_fault(frame);
        ++answers_;
        // At first what is at fault is only carried stiffly: another branch may have come near, whose field
        // moves it in a way that it cannot follow.
        if (answers_ == 1) {
            stiff_ = bad;
            return;
        }
        // Where that did not help, branches are held as they were before, and as stiff as they were.
        if (answers_ == 2) {
            stiff_ = combined(std::ranges::set_union, combined(std::ranges::set_difference, stiff_, bad),
                              combined(std::ranges::set_intersection, last_stiff_, bad));
        }
        const std::vector<std::uint8_t> before = is_held_;
        hold_faults(mesh_, frame, is_held_);
        if (is_held_ == before) {
            stiff_ = combined(std::ranges::set_symmetric_difference, stiff_, bad);
            if (turned_) hold_more(mesh_.skeleton(), is_held_);
            turned_ = !turned_;
        } else if (answers_ > kPatience) {
            hold_more(mesh_.skeleton(), is_held_);
        }
    }

    const Vertices& stiff() const { return stiff_; }
    std::span<const std::uint8_t> is_held() const { return is_held_; }
    std::uint32_t held_nodes() const {
        return static_cast<std::uint32_t>(std::ranges::count(is_held_, std::uint8_t{1}));
    }

  private:
    const CarriedMesh& mesh_;
    const Vertices& last_stiff_;
    std::vector<std::uint8_t> is_held_;
    Vertices stiff_;
    int answers_ = 0;
    bool turned_ = false;  // soft and stiff were exchanged where holding did not help
};

}  // namespace

SoundFrames::SoundFrames(CarriedMesh& mesh)
    : mesh_(mesh), last_(rest_pose(mesh.skeleton())), positions_(mesh.made().quads().mesh.positions) {}

SoundFrame SoundFrames::next(const Pose& wanted, const Context& ctx) {
    constexpr int kSteps = 8;
    if (std::exchange(is_at_rest_, false)) {
        const Pose rest = last_;
        for (int i = 1; i < kSteps && !(wanted == rest); ++i)
            step(on_the_way(mesh_.skeleton(), rest, wanted, static_cast<double>(i) / kSteps), ctx);
    }
    return step(wanted, ctx);
}

SoundFrame SoundFrames::step(const Pose& wanted, const Context& ctx) {
    SoundFrame out;
    Remedy remedy(mesh_, last_stiff_);
    Pose pose = wanted;
    for (out.rounds = 1;; ++out.rounds) {
        ctx.throw_if_cancelled();
        CarriedFrame frame = mesh_.carry(pose, remedy.stiff(), ctx);
        if (out.rounds == 1) {
            out.folded = frame.folded.size();
            out.crossings = frame.crossings.size();
        }
        out.not_converged = frame.projected.not_converged;
        if (frame.is_sound()) {
            last_ = std::move(pose);
            last_stiff_ = remedy.stiff();
            positions_ = std::move(frame.positions);
            out.held_nodes = remedy.held_nodes();
            break;
        }
        if (out.rounds == kRounds) {
            out.whole_tree_held = true;
            out.held_nodes = mesh_.skeleton().size();
            break;
        }
        remedy.answer(frame);
        if (remedy.held_nodes() > 0) pose = held(mesh_.skeleton(), wanted, last_, remedy.is_held());
    }
    out.positions = positions_;
    out.pose = last_;
    return out;
}

}  // namespace coppice
