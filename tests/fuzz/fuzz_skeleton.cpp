// Feeds arbitrary bytes to the parsers of skeleton files; the first byte selects the parser. Accepted
// skeletons must be repairable, and the output of the writers for them must be readable.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

#include "coppice/base/error.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/io_skeleton/writer.h"

namespace {

using coppice::SkeletonFormat;

constexpr SkeletonFormat kFormats[]{
    SkeletonFormat::automatic, SkeletonFormat::swc,  SkeletonFormat::cylinders, SkeletonFormat::raycloud,
    SkeletonFormat::ply,       SkeletonFormat::gel,  SkeletonFormat::obj,       SkeletonFormat::json,
    SkeletonFormat::mat,       SkeletonFormat::rsml, SkeletonFormat::mtg};

void write_and_read_back(const coppice::Skeleton& skeleton, SkeletonFormat format) {
    const std::string text = coppice::encode_skeleton(skeleton, {.format = format});
    const coppice::Skeleton back = coppice::parse_skeleton(text, "back", {.format = format}).skeleton;
    if (back.tree_count() != skeleton.tree_count()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const SkeletonFormat format = kFormats[data[0] % std::size(kFormats)];
    const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
    std::optional<coppice::SkeletonFile> file;
    try {
        file = coppice::parse_skeleton(text, "fuzz", {.format = format});
    } catch (const coppice::Error&) {
        return 0;  // refused with a message, as expected
    }
    for (const SkeletonFormat out : {SkeletonFormat::swc, SkeletonFormat::ply, SkeletonFormat::obj,
                                     SkeletonFormat::json, SkeletonFormat::rsml, SkeletonFormat::mtg}) {
        write_and_read_back(file->skeleton, out);
    }
    return 0;
}
