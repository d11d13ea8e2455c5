#include "coppice/io/unread_format.h"

#include <algorithm>
#include <array>

#include "coppice/base/ascii.h"
#include "coppice/io/text.h"

namespace coppice {
namespace {

using namespace std::string_view_literals;

struct Signature {
    std::string_view start, text;
};
constexpr std::array<Signature, 8> kSignatures{
    {{"\x1f\x8b"sv, "compressed by gzip; unpack it first: gunzip FILE"},
     {"PK\x03\x04"sv, "a ZIP archive; unpack it first: unzip FILE"},
     {"7z\xbc\xaf"sv, "a 7z archive; unpack it first: 7z x FILE"},
     {"BZh"sv, "compressed by bzip2; unpack it first: bunzip2 FILE"},
     {"\xfd"
      "7zXZ"sv,
      "compressed by xz; unpack it first: unxz FILE"},
     {"\x28\xb5\x2f\xfd"sv, "compressed by Zstandard; unpack it first: unzstd FILE"},
     {"CCB2"sv, "a CloudCompare file, which is not read; save it in CloudCompare as LAZ, LAS or PLY"},
     {"SQLite format 3\0"sv,
      "an SQLite database; list a library of branches by: coppice library list FILE"}}};

constexpr std::string_view kGrid =
    "an ESRI ASCII grid of heights, which is not read; convert its cells to points: gdal_translate -of XYZ "
    "FILE POINTS.xyz";
constexpr std::string_view kNeurolucida =
    "a Neurolucida tracing, which is not read; convert it to SWC: morph-tool convert file FILE TRACING.swc";
constexpr std::string_view kNeurolucidaXml =
    "a Neurolucida XML tracing, which is not read; save it as SWC, for example with Simple Neurite Tracer";
constexpr std::string_view kMorphIo =
    "a neuron in the HDF5 format of MorphIO, which is not read; convert it to SWC: morph-tool convert file "
    "FILE NEURON.swc";
constexpr std::string_view kHdf5 =
    "an HDF5 file, which is not read; save points as LAZ, LAS or PLY, and a skeleton as SWC";

constexpr std::size_t kMaxHead = std::size_t{1} << 16;

bool contains(std::string_view text, std::string_view part) { return text.find(part) != text.npos; }

/// Returns the text without leading white space and comments, which extend from ; to the end of the line.
std::string_view behind_comments(std::string_view text) {
    for (;;) {
        text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
        if (!text.starts_with(';')) return text;
        text.remove_prefix(std::min(text.find('\n'), text.size()));
    }
}

/// Returns whether the text consists of S-expressions that name a structure of a neuron or begin like a file
/// of Neurolucida.
bool is_neurolucida(std::string_view head) {
    constexpr std::array kParts{"(CellBody"sv, "(Axon"sv,     "(Dendrite"sv,   "(Apical"sv,
                                "(Color"sv,    "(Sections"sv, "(ImageCoords"sv};
    const std::string_view first = behind_comments(head);
    return first.starts_with('(') &&
           std::ranges::any_of(kParts, [&](std::string_view part) { return contains(first, part); });
}

bool is_grid(std::string_view head) {
    return to_lower(trimmed(head.substr(0, 64))).starts_with("ncols ") && contains(to_lower(head), "nrows");
}

}  // namespace

std::optional<std::string_view> unread_format(std::string_view bytes) {
    for (const Signature& known : kSignatures)
        if (bytes.starts_with(known.start)) return known.text;
    const std::string_view head = bytes.substr(0, kMaxHead);
    if (head.starts_with("\x89HDF\r\n\x1a\n"))
        return contains(head, "points") && contains(head, "structure") ? kMorphIo : kHdf5;
    if (is_grid(head)) return kGrid;
    if (is_neurolucida(head)) return kNeurolucida;
    if (behind_comments(head).starts_with('<') && contains(head, "<mbf")) return kNeurolucidaXml;
    return {};
}

}  // namespace coppice
