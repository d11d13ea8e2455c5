#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "coppice/io_skeleton/parsers_internal.h"
#include "coppice/io_skeleton/writers_internal.h"

namespace coppice {

namespace {

constexpr std::uint32_t kFree = 0xffffffffu;

/// Returns the index of the node with each number; empty unless the numbers are a permutation from 0.
std::optional<std::vector<std::uint32_t>> nodes_by_number(const std::vector<double>& numbers) {
    std::vector<std::uint32_t> node(numbers.size(), kFree);
    for (std::uint32_t i = 0; i < numbers.size(); ++i) {
        if (!(numbers[i] >= 0) || !(numbers[i] < static_cast<double>(numbers.size()))) return std::nullopt;
        const auto number = static_cast<std::uint32_t>(numbers[i]);
        if (static_cast<double>(number) != numbers[i] || node[number] != kFree) return std::nullopt;
        node[number] = i;
    }
    return node;
}

}  // namespace

void put_in_written_order(RawSkeleton& raw) {
    const auto numbers = std::ranges::find(raw.attributes, kNodeNumber, &RawAttribute::name);
    if (numbers == raw.attributes.end()) return;
    const auto order = nodes_by_number(numbers->values);
    if (!order) return;
    std::vector<RawNode> nodes;
    nodes.reserve(raw.nodes.size());
    for (const std::uint32_t i : *order) {
        RawNode node = raw.nodes[i];
        if (node.parent >= 0) {
            node.parent = static_cast<std::int64_t>(numbers->values[static_cast<std::size_t>(node.parent)]);
        }
        node.id = static_cast<std::int64_t>(nodes.size());
        nodes.push_back(node);
    }
    raw.nodes = std::move(nodes);
    raw.attributes.erase(numbers);
    std::vector<double> sorted(order->size());
    for (RawAttribute& a : raw.attributes) {
        for (std::size_t i = 0; i < sorted.size(); ++i) sorted[i] = a.values[(*order)[i]];
        a.values.swap(sorted);
    }
}

}  // namespace coppice
