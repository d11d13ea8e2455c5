#include <algorithm>

#include "coppice/studio/document/prefix_internal.h"

namespace coppice::studio_internal {
namespace {

constexpr std::int64_t kBytesOfPrefix = sizeof(Prefix) + 128;  // and for its entry in the parent

std::int64_t count_bytes(const Record& record) {
    std::size_t bytes = record.message.size();
    for (const auto& name : record.changed) bytes += sizeof(name) + name.second.size();
    return static_cast<std::int64_t>(bytes);
}

}  // namespace

Prefix::~Prefix() {
    leave_tree();
    // Releases the chain in a loop: recursive destruction of a long chain would overflow the stack.
    while (before && before.use_count() == 1) {
        Ptr last = std::move(before);
        last->leave_tree();
        before = std::move(last->before);
    }
}

void Prefix::leave_tree() {
    if (before) before->next_.erase({statement.edition, *statement.text});
    count(-bytes_);
}

void Prefix::count(std::int64_t bytes) {
    bytes_ += bytes;
    *tree_bytes_ += static_cast<std::uint64_t>(bytes);
}

Prefix::Ptr Prefix::with(const StatementText& next) {
    const auto known = next_.find({next.edition, *next.text});
    if (known != next_.end()) return known->second.lock();
    auto made = std::make_shared<Prefix>();
    made->tree_bytes_ = tree_bytes_;
    made->before = shared_from_this();
    made->statement = next;
    made->depth = depth + 1;
    made->lines = lines + 1 + static_cast<std::uint32_t>(std::ranges::count(*next.text, '\n'));
    made->count(kBytesOfPrefix + static_cast<std::int64_t>(next.text->size()));
    made->list_bytes = list_bytes + static_cast<std::uint64_t>(made->bytes_);
    next_[{next.edition, *made->statement.text}] = made;
    return made;
}

void Prefix::note(Record made) {
    count(count_bytes(made) - (record ? count_bytes(*record) : 0));
    record = std::move(made);
}

std::vector<Prefix::Ptr> Prefix::path() {
    std::vector<Ptr> out;
    for (Ptr at = shared_from_this(); at->before; at = at->before) out.push_back(at);
    std::ranges::reverse(out);
    return out;
}

}  // namespace coppice::studio_internal
