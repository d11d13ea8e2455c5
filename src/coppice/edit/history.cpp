#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "coppice/base/error.h"
#include "coppice/edit/editable_tree.h"
#include "coppice/edit/motion_internal.h"

namespace coppice {

using namespace edit_internal;

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kMinFollowers = 6;  // fewer nodes need less memory than the motion
constexpr std::uint8_t kFollows = 1 << 5;   // flag in the byte of changed words

/// Appends a number with seven bits per byte, least significant first, so that small numbers, such as
/// differences, need little memory.
void put_number(Bytes& bytes, std::uint32_t value) {
    for (; value >= 128; value >>= 7) bytes.push_back(static_cast<std::uint8_t>(value | 128));
    bytes.push_back(static_cast<std::uint8_t>(value));
}

std::uint32_t take_number(const Bytes& bytes, std::size_t& at) {
    std::uint32_t value = 0;
    for (int shift = 0;; shift += 7) {
        const std::uint8_t byte = bytes[at++];
        value |= static_cast<std::uint32_t>(byte & 127) << shift;
        if (byte < 128) return value;
    }
}

template <class T>
void put_bits(Bytes& bytes, const T& value) {
    const auto* first = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), first, first + sizeof(T));
}

template <class T>
void take_bits(const Bytes& bytes, std::size_t& at, T& value) {
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    at += sizeof(T);
}

/// Appends a motion without the members that have their default value.
void put_motion(Bytes& bytes, const Motion& motion) {
    const Motion usual{.from = motion.from, .to = Vec3d(motion.from), .turn = {}};
    const bool shifts = motion.to != usual.to, turns = motion.turn != usual.turn,
               scales = motion.factor != usual.factor;
    bytes.push_back(static_cast<std::uint8_t>((shifts ? 1 : 0) | (turns ? 2 : 0) | (scales ? 4 : 0)));
    put_bits(bytes, motion.from);
    if (shifts) put_bits(bytes, motion.to);
    if (turns) put_bits(bytes, motion.turn);
    if (scales) put_bits(bytes, motion.factor);
}

Motion take_motion(const Bytes& bytes, std::size_t& at) {
    const std::uint8_t has = bytes[at++];
    Motion motion{.from = {}, .to = {}, .turn = {}};
    take_bits(bytes, at, motion.from);
    motion.to = Vec3d(motion.from);
    if ((has & 1) != 0) take_bits(bytes, at, motion.to);
    if ((has & 2) != 0) take_bits(bytes, at, motion.turn);
    if ((has & 4) != 0) take_bits(bytes, at, motion.factor);
    return motion;
}

/// Returns the rank of a float in ascending order; -0 and 0 have different ranks.
std::uint32_t rank(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return (bits >> 31) != 0 ? ~bits : bits | 0x80000000u;
}

float of_rank(std::uint32_t rank) {
    return std::bit_cast<float>((rank >> 31) != 0 ? rank & 0x7fffffffu : ~rank);
}

/// Range of the number of floats between two positions per axis that fits into one byte for all three axes:
/// usually 0 or 1.
constexpr std::int32_t kMinStep = -3, kSteps = 6;
constexpr std::uint8_t kFarther = 255;

void put_steps(Bytes& bytes, Vec3 from, Vec3 to) {
    std::array<std::int32_t, 3> steps{};
    std::uint32_t code = 0;
    bool near = true;
    for (int i = 0; i < 3; ++i) {
        const auto step = static_cast<std::int32_t>(rank(to[i]) - rank(from[i]));
        steps[static_cast<std::size_t>(i)] = step;
        near = near && step >= kMinStep && step < kMinStep + kSteps;
        code = code * kSteps + static_cast<std::uint32_t>(step - kMinStep);
    }
    bytes.push_back(near ? static_cast<std::uint8_t>(code) : kFarther);
    if (near) return;
    for (const std::int32_t s : steps)
        put_number(bytes, (static_cast<std::uint32_t>(s) << 1) ^ static_cast<std::uint32_t>(s >> 31));
}

Vec3 take_steps(const Bytes& bytes, std::size_t& at, Vec3 from) {
    std::uint32_t code = bytes[at++];
    std::array<std::uint32_t, 3> steps{};
    if (code == kFarther) {
        for (std::uint32_t& s : steps) {
            const std::uint32_t z = take_number(bytes, at);
            s = (z >> 1) ^ (0u - (z & 1));
        }
    } else {
        for (std::size_t i = 3; i-- > 0; code /= kSteps)
            steps[i] = code % kSteps + static_cast<std::uint32_t>(kMinStep);
    }
    return {of_rank(rank(from.x) + steps[0]), of_rank(rank(from.y) + steps[1]),
            of_rank(rank(from.z) + steps[2])};
}

/// The words of a node that deltas combine: parent, position, radius.
using Words = std::array<std::uint32_t, 5>;

Words to_words(StableId parent, Vec3 p, float radius) {
    return {parent.index(), std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
            std::bit_cast<std::uint32_t>(p.z), std::bit_cast<std::uint32_t>(radius)};
}

bool same_bits(Vec3 a, Vec3 b) { return to_words({}, a, 0) == to_words({}, b, 0); }

}  // namespace

namespace edit_internal {

Vec3 moved(const Motion& motion, Vec3 p) {
    return Vec3(motion.to + motion.turn(Vec3d(p) - Vec3d(motion.from)) * motion.factor);
}

Vec3 moved_back(const Motion& motion, Vec3 p) {
    return Vec3(Vec3d(motion.from) + inverse(motion.turn)((Vec3d(p) - motion.to) / motion.factor));
}

}  // namespace edit_internal

/// Encoding: first the motions that many nodes followed, then the changed nodes, each with the difference of
/// its id from the previous one, the flags of changed words, and these words combined by exclusive or. Nodes
/// that followed a motion store, instead of their position, the index of the motion and the rounding error of
/// its inverse.
EditableTree::Delta EditableTree::delta_from(const Nodes& before, std::uint32_t slots_before,
                                             Moves moves) const {
    moves.keep_followed(before, *this);
    Delta delta{.bytes = {}, .slots_before = slots_before, .slots_after = slots()};
    put_number(delta.bytes, static_cast<std::uint32_t>(moves.motions.size()));
    for (const Motion& m : moves.motions) put_motion(delta.bytes, m);
    std::uint32_t last = 0;
    auto follower = moves.followers.begin();
    for (const auto& [n, was] : before) {
        const Node is = node(n);
        if (is == was) continue;
        while (follower != moves.followers.end() && follower->first < n) ++follower;
        const bool follows = follower != moves.followers.end() && follower->first == n;
        const Words a = to_words(was.parent, was.position, was.radius);
        const Words b = to_words(is.parent, follows ? was.position : is.position, is.radius);
        std::uint8_t changed = follows ? kFollows : 0;
        for (std::size_t i = 0; i < a.size(); ++i) changed |= static_cast<std::uint8_t>((a[i] != b[i]) << i);
        put_number(delta.bytes, n.index() - last);
        last = n.index();
        delta.bytes.push_back(changed);
        for (std::size_t i = 0; i < a.size(); ++i) {
            if (a[i] != b[i]) put_number(delta.bytes, a[i] ^ b[i]);
        }
        if (!follows) continue;
        if (moves.motions.size() > 1) put_number(delta.bytes, follower->second);
        put_steps(delta.bytes, moved_back(moves.motions[follower->second], is.position), was.position);
    }
    delta.bytes.shrink_to_fit();
    return delta;
}

EditChange EditableTree::flip(const Delta& delta, bool forward) {
    resize(std::max(delta.slots_before, delta.slots_after));
    std::size_t at = 0;
    std::vector<Motion> motions(take_number(delta.bytes, at));
    for (Motion& m : motions) m = take_motion(delta.bytes, at);
    Nodes before, after;
    std::uint32_t last = 0;
    while (at < delta.bytes.size()) {
        const StableId n(last += take_number(delta.bytes, at));
        before.emplace_back(n, node(n));
        const std::uint8_t changed = delta.bytes[at++];
        Words words = to_words(parent_[n], position_[n], radius_[n]);
        for (std::size_t i = 0; i < words.size(); ++i) {
            if ((changed >> i & 1) != 0) words[i] ^= take_number(delta.bytes, at);
        }
        Vec3 p{std::bit_cast<float>(words[1]), std::bit_cast<float>(words[2]),
               std::bit_cast<float>(words[3])};
        if ((changed & kFollows) != 0) {
            const Motion& motion = motions[motions.size() > 1 ? take_number(delta.bytes, at) : 0];
            const Vec3 back = take_steps(delta.bytes, at, moved_back(motion, p));
            p = forward ? moved(motion, p) : back;
        }
        after.emplace_back(n, Node{StableId(words[0]), p, std::bit_cast<float>(words[4])});
    }
    assign(after);
    resize(forward ? delta.slots_after : delta.slots_before);
    return change_from(before);
}

/// Keeps only motions that enough nodes followed bit-identically and without other moves, and these nodes,
/// sorted by id.
void EditableTree::Moves::keep_followed(const Nodes& before, const EditableTree& tree) {
    std::ranges::stable_sort(followers, {}, [](const auto& f) { return f.first; });
    const auto same_node = [](const auto& a, const auto& b) { return a.first == b.first; };
    followers.erase(std::unique(followers.begin(), followers.end(), same_node), followers.end());
    auto was = before.begin();
    std::vector<std::uint32_t> count(motions.size());
    std::erase_if(followers, [&](const auto& f) {
        while (was != before.end() && was->first < f.first) ++was;
        const bool follows =
            was != before.end() && was->first == f.first && tree.contains(f.first) &&
            same_bits(moved(motions[f.second], was->second.position), tree.position(f.first));
        if (follows) ++count[f.second];
        return !follows;
    });
    std::erase_if(followers, [&](const auto& f) { return count[f.second] < kMinFollowers; });
    std::vector<std::uint32_t> number(motions.size());
    std::uint32_t kept = 0;
    for (std::size_t i = 0; i < motions.size(); ++i) {
        if (count[i] < kMinFollowers) continue;
        number[i] = kept;
        motions[kept++] = motions[i];
    }
    motions.resize(kept, Motion{.from = {}, .to = {}, .turn = {}});
    for (auto& f : followers) f.second = number[f.second];
}

void EditableTree::remember(Delta delta) {
    for (const Delta& d : undone_) history_bytes_ -= sizeof(Delta) + d.bytes.capacity();
    undone_.clear();
    history_bytes_ += sizeof(Delta) + delta.bytes.capacity();
    done_.push_back(std::move(delta));
}

EditChange EditableTree::undo() {
    COPPICE_ASSERT(!done_.empty());
    EditChange change = flip(done_.back(), false);
    undone_.push_back(std::move(done_.back()));
    done_.pop_back();
    return change;
}

EditChange EditableTree::redo() {
    COPPICE_ASSERT(!undone_.empty());
    EditChange change = flip(undone_.back(), true);
    done_.push_back(std::move(undone_.back()));
    undone_.pop_back();
    return change;
}

void EditableTree::limit_history(std::size_t bytes) {
    while (history_bytes_ > bytes && done_.size() > 1) {
        history_bytes_ -= sizeof(Delta) + done_.front().bytes.capacity();
        done_.pop_front();
    }
}

}  // namespace coppice
