#include "coppice/pipeline/carry/sound_frames.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace coppice {
namespace {

constexpr std::uint32_t kRounds = 12;
constexpr std::uint32_t kRoundsOfFaults = 5;  // after which what is held grows by itself

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

}  // namespace

SoundFrames::SoundFrames(CarriedMesh& mesh)
    : mesh_(mesh), last_(rest_pose(mesh.skeleton())), positions_(mesh.made().quads().mesh.positions) {}

SoundFrame SoundFrames::next(const Pose& wanted, const Context& ctx) {
    SoundFrame out;
    std::vector<std::uint8_t> is_held(wanted.positions.size());
    std::vector<std::uint32_t> stiff;
    Pose pose = wanted;
    for (out.rounds = 1;; ++out.rounds) {
        ctx.throw_if_cancelled();
        CarriedFrame frame = mesh_.carry(pose, stiff, ctx);
        if (out.rounds == 1) {
            out.folded = frame.folded.size();
            out.crossings = frame.crossings.size();
        }
        out.not_converged = frame.projected.not_converged;
        if (frame.is_sound()) {
            last_ = std::move(pose);
            positions_ = std::move(frame.positions);
            break;
        }
        if (out.rounds == kRounds) {
            out.whole_tree_held = true;
            std::ranges::fill(is_held, std::uint8_t{1});
            break;
        }
        // At first what is at fault is only carried stiffly: another branch may have come near, whose field
        // moves it in a way that it cannot follow.
        const std::size_t stiff_before = stiff.size();
        std::vector<std::uint32_t> more;
        std::ranges::set_union(stiff, mesh_.at_fault(frame), std::back_inserter(more));
        stiff = std::move(more);
        if (out.rounds == 1 && stiff.size() > stiff_before) continue;
        const std::vector<std::uint8_t> before = is_held;
        hold_faults(mesh_, frame, is_held);
        if (is_held == before || out.rounds > kRoundsOfFaults) hold_more(mesh_.skeleton(), is_held);
        pose = held(mesh_.skeleton(), wanted, last_, is_held);
    }
    out.held_nodes = static_cast<std::uint32_t>(std::ranges::count(is_held, std::uint8_t{1}));
    out.positions = positions_;
    out.pose = last_;
    return out;
}

}  // namespace coppice
