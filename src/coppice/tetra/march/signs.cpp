#include <algorithm>

#include "coppice/tetra/march/cuts_internal.h"

namespace coppice::tetra_internal {
namespace {

using Order = std::array<std::uint8_t, 4>;

constexpr bool is_even(const Order& o) {
    bool even = true;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = i + 1; j < 4; ++j) {
            if (o[i] > o[j]) even = !even;
        }
    }
    return even;
}

/// Returns the first even permutation that begins with the corners in `first`.
constexpr Order even_order(std::uint32_t first) {
    Order o{0, 1, 2, 3};
    do {
        bool sorted = true;
        for (std::size_t i = 1; i < 4; ++i) sorted &= (first >> o[i] & 1) <= (first >> o[i - 1] & 1);
        if (sorted && is_even(o)) break;
    } while (std::next_permutation(o.begin(), o.end()));
    return o;
}

constexpr std::uint8_t edge_number(std::uint8_t a, std::uint8_t b) {
    std::uint8_t e = 0;
    while (kTetraEdges[e][0] != std::min(a, b) || kTetraEdges[e][1] != std::max(a, b)) ++e;
    return e;
}

/// Returns the corner of the cut between a corner inside and one that is not.
constexpr std::uint8_t cut_corner(std::uint8_t a, std::uint8_t b, std::uint32_t inside, std::uint32_t on) {
    const std::uint8_t other = (inside >> a & 1) != 0 ? b : a;
    if ((on >> other & 1) != 0) return static_cast<std::uint8_t>(kCutVertex + other);
    return edge_number(a, b);
}

constexpr Cut make_cut(std::uint32_t inside, std::uint32_t on) {
    const int count = std::popcount(inside);
    if (count == 0 || count == 4) return {};
    const Order o = even_order(count == 3 ? 15 - inside : inside);
    const auto corner = [&](std::size_t i, std::size_t j) { return cut_corner(o[i], o[j], inside, on); };
    std::array<std::uint8_t, 4> corners{};
    std::size_t size = 3;
    if (count == 1) {
        corners = {corner(0, 1), corner(0, 2), corner(0, 3), 0};
    } else if (count == 3) {
        corners = {corner(0, 1), corner(0, 3), corner(0, 2), 0};
    } else {
        corners = {corner(0, 2), corner(0, 3), corner(1, 3), corner(1, 2)};
        size = 4;
    }
    Cut out;
    for (std::size_t i = 0; i < size; ++i) {
        if (corners[i] != corners[(i + 1) % size]) out.corners[out.size++] = corners[i];
    }
    if (out.size < 3) out.size = 0;
    return out;
}

constexpr std::array<Cut, 256> make_cuts() {
    std::array<Cut, 256> out{};
    for (std::uint32_t inside = 0; inside < 16; ++inside) {
        for (std::uint32_t on = 0; on < 16; ++on) {
            if ((inside & on) == 0) out[16 * inside + on] = make_cut(inside, on);
        }
    }
    return out;
}

/// Copies bits from .. from + count to at .. of words that are 0 there. Accesses one word past the end.
void append(std::span<const std::uint64_t> source, std::size_t from, std::uint32_t count,
            std::span<std::uint64_t> out, std::size_t at) {
    for (std::uint32_t done = 0; done < count; done += 64) {
        const std::size_t i = from + done, o = at + done, skip = i % 64, gap = o % 64;
        // A shift by 64 is undefined, so it is divided into two.
        std::uint64_t bits = source[i / 64] >> skip | source[i / 64 + 1] << 1 << (63 - skip);
        if (count - done < 64) bits &= (std::uint64_t{1} << (count - done)) - 1;
        out[o / 64] |= bits << gap;
        out[o / 64 + 1] |= bits >> 1 >> (63 - gap);
    }
}

constexpr std::array<Cut, 256> kMadeCuts = make_cuts();

}  // namespace

void gather_bits(const TetraRefinement& refinement, const RankedBits& bits, std::uint32_t tetra,
                 LocalBits& out) {
    const auto& first = refinement.pattern(tetra).first_vertex;
    const std::span<const std::uint64_t> words = bits.words();
    if (first.back() > 64) {
        std::fill_n(out.begin(), first.back() / 64 + 2, 0);
        for (std::uint32_t g = 0; g < TetraPattern::kGroups; ++g)
            append(words, refinement.first_vertex(tetra, g), first[g + 1] - first[g], out, first[g]);
        return;
    }
    std::uint64_t word = 0;
    for (std::uint32_t g = 0; g < TetraPattern::kGroups; ++g) {
        const std::uint32_t count = first[g + 1] - first[g];
        if (count == 0) continue;
        const std::size_t from = refinement.first_vertex(tetra, g), skip = from % 64;
        const std::uint64_t found = words[from / 64] >> skip | words[from / 64 + 1] << 1 << (63 - skip);
        word |= (found & ~std::uint64_t{0} >> (64 - count)) << first[g];
    }
    out[0] = word;
    out[1] = 0;
}

bool LocalSigns::gather(const TetraRefinement& refinement, const Samples& samples, std::uint32_t tetra) {
    const std::uint32_t count = refinement.pattern(tetra).first_vertex.back();
    gather_bits(refinement, samples.inside, tetra, inside_);
    bool any = false, all = true;
    for (std::uint32_t first = 0; first < count; first += 64) {
        const std::uint64_t whole = ~std::uint64_t{0} >> (count - first < 64 ? 64 - (count - first) : 0);
        any |= inside_[first / 64] != 0;
        all &= inside_[first / 64] == whole;
    }
    if (!any || all) return false;
    gather_bits(refinement, samples.on, tetra, on_);
    for (std::uint32_t v = 0; v < count; ++v)
        state_[v] = static_cast<std::uint8_t>(get_bit(inside_, v) << 4 | get_bit(on_, v));
    return true;
}

}  // namespace coppice::tetra_internal

const std::array<coppice::tetra_kernel::Cut, 256> coppice::tetra_kernel::kCuts =
    coppice::tetra_internal::kMadeCuts;
