#include <bit>
#include <cstdint>
#include <cstring>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/io_database/skeleton_blob_internal.h"

namespace coppice::io_internal {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied without conversion");
static_assert(sizeof(Vec3) == 12 && sizeof(NodeId) == 4);

constexpr std::size_t kBytesPerNode = sizeof(NodeId) + sizeof(Vec3) + sizeof(float);

template <class T>
void append(std::vector<std::byte>& out, std::span<const T> values) {
    const auto bytes = std::as_bytes(values);
    out.insert(out.end(), bytes.begin(), bytes.end());
}

template <class T>
std::vector<T> take(std::span<const std::byte>& bytes, std::size_t count) {
    std::vector<T> out(count);
    std::memcpy(static_cast<void*>(out.data()), bytes.data(), count * sizeof(T));
    bytes = bytes.subspan(count * sizeof(T));
    return out;
}

}  // namespace

std::vector<std::byte> encode_blob(const Skeleton& skeleton) {
    const std::uint32_t size = skeleton.size();
    std::vector<std::byte> out;
    out.reserve(sizeof size + size * kBytesPerNode);
    append(out, std::span(&size, 1));
    append(out, skeleton.parents());
    append(out, skeleton.positions());
    append(out, skeleton.radii());
    return out;
}

std::optional<Skeleton> decode_blob(std::span<const std::byte> bytes) {
    std::uint32_t size = 0;
    if (bytes.size() < sizeof size) return {};
    std::memcpy(&size, bytes.data(), sizeof size);
    bytes = bytes.subspan(sizeof size);
    if (size == 0 || bytes.size() != size * kBytesPerNode) return {};
    auto parents = take<NodeId>(bytes, size);
    auto positions = take<Vec3>(bytes, size);
    auto radii = take<float>(bytes, size);
    try {
        return Skeleton(std::move(parents), std::move(positions), std::move(radii));
    } catch (const InvalidInput&) {
        return {};
    }
}

}  // namespace coppice::io_internal
