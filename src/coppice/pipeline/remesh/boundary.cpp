#include "coppice/pipeline/remesh/boundary_internal.h"

#include <algorithm>
#include <array>

namespace coppice {
namespace {

using Edge = std::array<std::uint32_t, 2>;  // from, to

std::vector<Edge> open_edges(std::span<const Triangle> faces, std::span<const std::uint8_t> rim) {
    std::vector<Edge> edges;
    for (const Triangle& face : faces) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Edge e{face[k], face[(k + 1) % 3]};
            if (rim.empty() || (rim[e[0]] != 0 && rim[e[1]] != 0)) edges.push_back(e);
        }
    }
    std::sort(edges.begin(), edges.end());
    std::vector<Edge> open;
    for (const Edge& e : edges) {
        if (!std::binary_search(edges.begin(), edges.end(), Edge{e[1], e[0]})) open.push_back(e);
    }
    return open;
}

}  // namespace

Boundary compute_boundary(std::span<const Triangle> faces, std::span<const std::uint8_t> rim) {
    Boundary out;
    const std::vector<Edge> open = open_edges(faces, rim);
    const auto leaving = [&](std::uint32_t v) {
        return std::lower_bound(open.begin(), open.end(), Edge{v, 0}) - open.begin();
    };
    for (std::size_t i = 1; i < open.size(); ++i) {
        const bool again = open[i][0] == open[i - 1][0];
        if (again && (out.pinched.empty() || out.pinched.back() != open[i][0]))
            out.pinched.push_back(open[i][0]);
    }
    const auto is_pinched = [&](std::uint32_t v) {
        return std::binary_search(out.pinched.begin(), out.pinched.end(), v);
    };
    std::vector<bool> seen(open.size());
    for (std::size_t start = 0; start < open.size(); ++start) {
        Loop loop;
        bool whole = true;
        for (std::size_t i = start; !seen[i]; i = static_cast<std::size_t>(leaving(open[i][1]))) {
            seen[i] = true;
            whole &= !is_pinched(open[i][0]);
            loop.push_back(open[i][0]);
        }
        if (whole && !loop.empty()) out.loops.push_back(std::move(loop));
    }
    return out;
}

}  // namespace coppice
