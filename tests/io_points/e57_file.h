#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace e57_file {

/// A field of generated scans with its values as stored: minus the minimum, or the bits of a float.
struct Field {
    std::string name, attributes;
    unsigned bits = 0;
    std::vector<std::uint64_t> stored;
};

inline std::uint64_t to_bits(double v) {
    std::uint64_t bits;
    std::memcpy(&bits, &v, sizeof v);
    return bits;
}
inline std::uint64_t to_bits(float v) {
    std::uint32_t bits;
    std::memcpy(&bits, &v, sizeof v);
    return bits;
}

struct Scan {
    std::vector<Field> fields;
    std::string before_points;  ///< additional XML of the scan: its pose, limits of colours
};

/// Packs values consecutively, least significant bits first.
inline std::string packed(const Field& field) {
    std::string bytes;
    std::size_t at = 0;
    for (const std::uint64_t value : field.stored) {
        for (unsigned b = 0; b < field.bits; ++b, ++at) {
            if (at % 8 == 0) bytes += '\0';
            if (value >> b & 1u) bytes.back() = static_cast<char>(bytes.back() | 1 << at % 8);
        }
    }
    return bytes;
}

template <class T>
void add(std::string& bytes, T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i)
        bytes += static_cast<char>(static_cast<std::uint64_t>(value) >> 8 * i);
}

/// Computes CRC-32C bit by bit.
inline std::uint32_t checksum(std::string_view bytes) {
    std::uint32_t crc = 0xffffffffu;
    for (const char c : bytes) {
        for (int b = 0; b < 8; ++b) {
            const bool odd = ((crc ^ static_cast<std::uint8_t>(c) >> b) & 1u) != 0;
            crc = odd ? crc >> 1 ^ 0x82f63b78u : crc >> 1;
        }
    }
    return crc ^ 0xffffffffu;
}

/// Updates the checksum of a modified page, so that the reader sees the modification.
inline void mend(std::string& bytes, std::size_t page) {
    const std::uint32_t crc = checksum(std::string_view(bytes).substr(1024 * page, 1020));
    for (std::size_t i = 0; i < 4; ++i)
        bytes[1024 * page + 1020 + i] = static_cast<char>(crc >> (24 - 8 * i));
}

/// Returns the offset of a byte in pages with checksums.
inline std::uint64_t physical(std::uint64_t logical) { return logical / 1020 * 1024 + logical % 1020; }

/// Returns the packets of a scan: `piece` bytes of each field in each packet, all fields in turn; for field f
/// the pieces are f bytes shorter, so that fields advance unequally. An index packet and an empty one come
/// first.
inline std::string packets(const Scan& scan, std::size_t piece) {
    std::vector<std::string> streams;
    for (const Field& field : scan.fields) streams.push_back(packed(field));
    std::string out;
    out += std::string("\0\0\x0f\0", 4) + std::string(12, '\0');
    out += std::string("\2\0\3\0", 4);
    for (bool any = true; any;) {
        any = false;
        std::string head, body;
        for (std::size_t f = 0; f < streams.size(); ++f) {
            const std::string part = streams[f].substr(0, piece > f ? piece - f : 1);
            streams[f].erase(0, part.size());
            add(head, static_cast<std::uint16_t>(part.size()));
            body += part;
            any = any || !streams[f].empty();
        }
        std::size_t size = 6 + head.size() + body.size();
        const std::size_t padding = (4 - size % 4) % 4;
        size += padding;
        out += std::string("\1\0", 2);
        add(out, static_cast<std::uint16_t>(size - 1));
        add(out, static_cast<std::uint16_t>(streams.size()));
        out += head + body + std::string(padding, '\0');
    }
    return out;
}

/// Returns an E57 file written without a library: scans, then the XML, in pages with checksums.
inline std::string make(const std::vector<Scan>& scans, std::size_t piece = 100,
                        const std::string& before_scans = "") {
    std::string content(48, '\0');
    std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\">" +
                      before_scans + "<data3D type=\"Vector\">";
    for (const Scan& scan : scans) {
        const std::uint64_t at = content.size();
        const std::string data = packets(scan, piece);
        content += '\1';
        content += std::string(7, '\0');
        add(content, static_cast<std::uint64_t>(32 + data.size()));
        add(content, physical(at + 32));
        add(content, std::uint64_t{0});
        content += data;
        xml += "<vectorChild type=\"Structure\">" + scan.before_points +
               "<points type=\"CompressedVector\" fileOffset=\"" + std::to_string(physical(at)) +
               "\" recordCount=\"" + std::to_string(scan.fields.empty() ? 0 : scan.fields[0].stored.size()) +
               "\"><prototype type=\"Structure\">";
        for (const Field& field : scan.fields) xml += "<" + field.name + " " + field.attributes + "/>";
        xml += "</prototype></points></vectorChild>";
    }
    xml += "</data3D></e57Root>\n";
    const std::uint64_t xml_at = content.size();
    content += xml;
    content.resize((content.size() + 1019) / 1020 * 1020, '\0');
    std::string head = "ASTM-E57";
    add(head, std::uint32_t{1});
    add(head, std::uint32_t{0});
    add(head, static_cast<std::uint64_t>(content.size() / 1020 * 1024));
    add(head, physical(xml_at));
    add(head, static_cast<std::uint64_t>(xml.size()));
    add(head, std::uint64_t{1024});
    content.replace(0, head.size(), head);
    std::string out;
    for (std::size_t page = 0; 1020 * page < content.size(); ++page) {
        out += content.substr(1020 * page, 1020) + std::string(4, '\0');
        mend(out, page);
    }
    return out;
}

}  // namespace e57_file
