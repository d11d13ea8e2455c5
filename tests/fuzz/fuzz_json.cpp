// Reads options as JSON from arbitrary bytes: those of a mesh, which have options of every type and nested
// options. Accepted options are in range and identical after writing and reading; others are refused with a
// sentence of one line.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>

#include "coppice/base/error.h"
#include "coppice/options/json.h"
#include "coppice/pipeline/mesh_skeleton.h"

namespace {

using coppice::Json;

void require(bool condition) {
    if (!condition) std::abort();
}

Json read_and_write(const Json& json) {
    coppice::MeshOptions options;
    from_json(json, option_fields(options), "fuzz.json");
    return to_json(option_fields(options));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const Json json = Json::parse(data, data + size, nullptr, false);
    if (json.is_discarded()) return 0;
    try {
        const Json written = read_and_write(json);
        require(read_and_write(written) == written);
    } catch (const coppice::Error& error) {
        require(std::string_view(error.what()).find('\n') == std::string_view::npos);
    }
    return 0;
}
