// Metadata of LAS files: variable length records, extra dimensions, coordinate reference systems.

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>

#include "coppice/io/text.h"
#include "coppice/io_points/las_internal.h"
#include "coppice/io_points/read_internal.h"

namespace coppice::io_internal {
namespace {

constexpr std::size_t kLongVlrHeader = 60;                    // [bytes] of records behind the points
constexpr std::uint16_t kGeoKeys = 34735, kGeoAscii = 34737;  // record ids
constexpr std::array<std::size_t, 11> kBytesOfType{0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};

/// Returns a text of fixed width up to its first zero.
std::string_view fixed_text(std::string_view bytes, std::size_t at, std::size_t width) {
    const std::string_view text = bytes.substr(at, width);
    return text.substr(0, text.find('\0'));
}

LasRecord record_at(std::string_view bytes, std::uint64_t at, std::size_t header, std::uint64_t size) {
    return {fixed_text(bytes, at + 2, 16), number_at<std::uint16_t>(bytes, at + 18),
            bytes.substr(at + header, size)};
}

/// Returns a number of type `type` without scale and offset.
double stored_number(std::string_view bytes, std::size_t at, std::uint8_t type) {
    switch (type) {
        case 1:
            return number_at<std::uint8_t>(bytes, at);
        case 2:
            return number_at<std::int8_t>(bytes, at);
        case 3:
            return number_at<std::uint16_t>(bytes, at);
        case 4:
            return number_at<std::int16_t>(bytes, at);
        case 5:
            return number_at<std::uint32_t>(bytes, at);
        case 6:
            return number_at<std::int32_t>(bytes, at);
        case 7:
            return static_cast<double>(number_at<std::uint64_t>(bytes, at));
        case 8:
            return static_cast<double>(number_at<std::int64_t>(bytes, at));
        case 9:
            return std::bit_cast<float>(number_at<std::uint32_t>(bytes, at));
        default:
            return number_at<double>(bytes, at);
    }
}

/// Returns the value that denotes missing data; stored in 64 bits for integers and as a double otherwise.
double read_no_data(std::string_view entry, std::uint8_t type) {
    constexpr std::size_t kNoData = 40;
    if (type >= 9) return number_at<double>(entry, kNoData);
    const bool is_signed = type % 2 == 0;
    return is_signed ? static_cast<double>(number_at<std::int64_t>(entry, kNoData))
                     : static_cast<double>(number_at<std::uint64_t>(entry, kNoData));
}

/// Returns a name for display: bytes that are not printable ASCII become question marks.
std::string printable(std::string_view text) {
    std::string out(trimmed(text));
    std::ranges::replace_if(
        out, [](char c) { return c < ' ' || c > '~'; }, '?');
    return out;
}

/// Returns the first quoted name of WKT after the keyword of the system: PROJCS["ETRS89 / UTM 32N", ...
std::string_view name_in_wkt(std::string_view wkt) {
    const std::size_t begin = wkt.find('"');
    if (begin == wkt.npos) return {};
    return wkt.substr(begin + 1, wkt.find('"', begin + 1) - begin - 1);
}

/// Returns "EPSG:25832" if the definition of the whole system ends with AUTHORITY["EPSG","25832"] or
/// ID["EPSG",25832].
std::string code_in_wkt(std::string_view wkt) {
    constexpr std::string_view kAuthority = "[\"EPSG\",";
    const std::size_t at = wkt.rfind(kAuthority);
    if (at == wkt.npos) return {};
    std::string_view code = wkt.substr(at + kAuthority.size());
    if (code.starts_with('"')) code.remove_prefix(1);
    const std::size_t digits = std::min(code.find_first_not_of("0123456789"), code.size());
    const std::string_view behind = code.substr(digits);
    if (digits == 0 || (behind != "]]" && behind != "\"]]")) return {};
    return fmt::format("EPSG:{}", code.substr(0, digits));
}

/// Returns the name by the GeoTIFF keys: an EPSG code, or the citation in their text.
std::string name_by_keys(std::string_view keys, std::string_view ascii) {
    constexpr std::uint16_t kGeographic = 2048, kProjected = 3072, kUserDefined = 32767;
    constexpr std::array<std::uint16_t, 3> kCitations{3073, 1026, 2049};
    std::string code;
    std::string_view citation;
    std::size_t rank = kCitations.size();
    for (std::size_t at = 8; at + 8 <= keys.size(); at += 8) {
        const auto key = number_at<std::uint16_t>(keys, at), place = number_at<std::uint16_t>(keys, at + 2),
                   count = number_at<std::uint16_t>(keys, at + 4),
                   value = number_at<std::uint16_t>(keys, at + 6);
        const bool is_code = (key == kProjected || key == kGeographic) && place == 0 && value != kUserDefined;
        if (is_code && (code.empty() || key == kProjected)) code = fmt::format("EPSG:{}", value);
        const auto found = static_cast<std::size_t>(std::ranges::find(kCitations, key) - kCitations.begin());
        if (place != kGeoAscii || found >= rank || value > ascii.size()) continue;
        rank = found;
        citation = ascii.substr(value, count);
    }
    if (!code.empty()) return code;
    return printable(citation.substr(0, citation.find_first_of(std::string_view("|\0", 2))));
}

}  // namespace

std::optional<double> LasDimension::value(std::string_view extra) const {
    const double stored = stored_number(extra, at, type);
    if (std::isnan(stored) || (no_data && stored == *no_data)) return {};
    return stored * scale + offset;
}

const LasDimension* LasHeader::tree_id() const {
    std::vector<std::string> names;
    for (const LasDimension& d : dimensions) names.push_back(d.name);
    const auto found = find_tree_ids(names);
    return found ? &dimensions[*found] : nullptr;
}

std::vector<LasRecord> las_records(std::string_view bytes, const LasHeader& h) {
    std::vector<LasRecord> records;
    std::uint64_t at = number_at<std::uint16_t>(bytes, 94);
    for (auto left = number_at<std::uint32_t>(bytes, 100); left > 0; --left) {
        if (at + kVlrHeader > std::min<std::uint64_t>(h.data, bytes.size())) break;
        const std::uint64_t size = number_at<std::uint16_t>(bytes, at + 20);
        if (at + kVlrHeader + size > bytes.size()) break;
        records.push_back(record_at(bytes, at, kVlrHeader, size));
        at += kVlrHeader + size;
    }
    if (h.minor < 4 || bytes.size() < kNewLasHeader) return records;
    at = number_at<std::uint64_t>(bytes, 235);
    for (auto left = number_at<std::uint32_t>(bytes, 243); left > 0; --left) {
        if (at > bytes.size() || bytes.size() - at < kLongVlrHeader) break;
        const auto size = number_at<std::uint64_t>(bytes, at + 20);
        if (size > bytes.size() - at - kLongVlrHeader) break;
        records.push_back(record_at(bytes, at, kLongVlrHeader, size));
        at += kLongVlrHeader + size;
    }
    return records;
}

std::vector<LasDimension> las_dimensions(std::span<const LasRecord> records, const LasHeader& h) {
    const auto found = std::ranges::find_if(
        records, [](const LasRecord& r) { return r.user == kLasSpecification && r.id == kExtraBytes; });
    std::vector<LasDimension> out;
    if (found == records.end()) return out;
    const std::size_t own = h.record - h.extra();
    std::size_t at = 0;
    for (std::size_t i = 0; i + kDimension <= found->data.size(); i += kDimension) {
        const std::string_view entry = found->data.substr(i, kDimension);
        LasDimension d{.name = printable(fixed_text(entry, 4, 32)), .at = at};
        d.type = number_at<std::uint8_t>(entry, 2);
        const auto options = number_at<std::uint8_t>(entry, 3);
        const bool is_scalar = d.type > 0 && d.type < kBytesOfType.size();
        // For raw bytes the options are their number; types up to 30 are the deprecated pairs and triples.
        const std::size_t size = is_scalar     ? kBytesOfType[d.type]
                                 : d.type == 0 ? options
                                 : d.type <= 30
                                     ? kBytesOfType[(d.type - 1u) % 10 + 1] * ((d.type - 1u) / 10 + 1)
                                     : own + 1;
        at += size;
        if (at > own) break;
        if (!is_scalar) continue;
        if (options & 1u) d.no_data = read_no_data(entry, d.type);
        if (options & 8u) d.scale = number_at<double>(entry, 112);
        if (options & 16u) d.offset = number_at<double>(entry, 136);
        out.push_back(std::move(d));
    }
    return out;
}

CoordinateSystem coordinate_system(std::span<const LasRecord> records) {
    CoordinateSystem out;
    for (const LasRecord& r : records) {
        const bool known = r.id == kWkt || (r.id >= kGeoKeys && r.id <= kGeoAscii);
        constexpr std::size_t kMax = 65535;  // [bytes] maximum size of a record before the points
        if (r.user == kLasProjection && known && r.data.size() <= kMax)
            out.records.push_back({r.id, std::string(r.data)});
    }
    return out;
}

}  // namespace coppice::io_internal

namespace coppice {

bool CoordinateSystem::has_wkt() const {
    return std::ranges::any_of(records, [](const Record& r) { return r.id == io_internal::kWkt; });
}

std::string CoordinateSystem::name() const {
    std::string_view keys, ascii;
    for (const Record& r : records) {
        if (r.id == io_internal::kGeoKeys) keys = r.data;
        if (r.id == io_internal::kGeoAscii) ascii = r.data;
        if (r.id != io_internal::kWkt) continue;
        const std::string_view wkt = trimmed(std::string_view(r.data).substr(0, r.data.find('\0')));
        const std::string code = io_internal::code_in_wkt(wkt);
        return code.empty() ? io_internal::printable(io_internal::name_in_wkt(wkt)) : code;
    }
    return io_internal::name_by_keys(keys, ascii);
}

}  // namespace coppice
