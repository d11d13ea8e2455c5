// Reads arbitrary bytes as a file of edits of a small tree: the edits are applied, or skipped with a reason
// of one line, or the file is refused with one; undoing all of them restores the tree.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "coppice/base/error.h"
#include "coppice/scene/edit_session.h"

namespace {

using namespace coppice;

void require(bool condition) {
    if (!condition) std::abort();
}

bool is_one_line(std::string_view text) { return text.find('\n') == text.npos; }

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const Skeleton first({NodeId::none(), NodeId(0), NodeId(1), NodeId(2), NodeId(1), NodeId(4)},
                         {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {1, 0, 1}, {2, 0, 1}},
                         {0.1f, 0.1f, 0.08f, 0.06f, 0.05f, 0.04f});
    EditSession session(first, {.max_memory = 2, .files = false, .outputs = false, .folder = {}});
    try {
        const auto replayed =
            session.replay({reinterpret_cast<const char*>(data), size}, "fuzz", {.threads = 1});
        for (const auto& edit : replayed.unbound) require(is_one_line(edit.reason));
        while (!session.history().empty()) session.run("undo");
        const Skeleton again = session.tree().skeleton();
        require(again.size() == first.size() && again.stable_ids().empty());
        for (const NodeId n : nodes(first)) require(again.position(n) == first.position(n));
    } catch (const Error& error) {
        require(is_one_line(error.what()));
    }
    return 0;
}
