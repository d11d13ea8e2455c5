#include "coppice/io/ply_header.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/io/text.h"

namespace coppice {

namespace {

struct TypeName {
    std::string_view name;
    PlyType type;
};

constexpr std::array<TypeName, 16> kTypeNames{{{"char", PlyType::int8},
                                               {"int8", PlyType::int8},
                                               {"uchar", PlyType::uint8},
                                               {"uint8", PlyType::uint8},
                                               {"short", PlyType::int16},
                                               {"int16", PlyType::int16},
                                               {"ushort", PlyType::uint16},
                                               {"uint16", PlyType::uint16},
                                               {"int", PlyType::int32},
                                               {"int32", PlyType::int32},
                                               {"uint", PlyType::uint32},
                                               {"uint32", PlyType::uint32},
                                               {"float", PlyType::float32},
                                               {"float32", PlyType::float32},
                                               {"double", PlyType::float64},
                                               {"float64", PlyType::float64}}};

/// Reads a header line by line; a line ends with LF, or with CR LF as in files written in text mode.
class HeaderParser {
  public:
    HeaderParser(std::string_view file, const std::string& source) : file_(file), source_(source) {}

    PlyHeader parse() {
        if (!is_ply(file_))
            throw InvalidInput(fmt::format("{}: not a PLY file: it does not start with 'ply'", source_));
        next();
        bool has_format = false;
        while (true) {
            if (!next())
                throw InvalidInput(
                    fmt::format("{}: the PLY header has no end_header; the file is truncated", source_));
            if (words_.empty()) continue;
            const std::string_view word = words_[0];
            if (word == "end_header") break;
            if (word == "comment" || word == "obj_info") {
                header_.comments.emplace_back(trimmed(line_.substr(line_.find(word) + word.size())));
            } else if (word == "format") {
                parse_format();
                has_format = true;
            } else if (word == "element") {
                parse_element();
            } else if (word == "property") {
                parse_property();
            } else {
                fail_at(source_, number_,
                        fmt::format("{} is not a keyword of a PLY header", in_quotes(word)));
            }
        }
        if (!has_format) throw InvalidInput(fmt::format("{}: the PLY header has no 'format' line", source_));
        for (const PlyElement& element : header_.elements) {
            if (element.count > 0 && element.properties.empty()) {
                throw InvalidInput(fmt::format("{}: the PLY element {} has rows but no properties", source_,
                                               in_quotes(element.name)));
            }
        }
        header_.data_offset = offset_;
        return std::move(header_);
    }

  private:
    bool next() {
        const std::size_t end = file_.find('\n', offset_);
        if (end == std::string_view::npos) return false;
        line_ = trimmed(file_.substr(offset_, end - offset_));
        offset_ = end + 1;
        ++number_;
        split_at_blanks(line_, words_);
        return true;
    }

    void parse_format() {
        if (words_.size() >= 2 && words_[1] == "ascii") {
            header_.encoding = PlyEncoding::ascii;
        } else if (words_.size() >= 2 && words_[1] == "binary_little_endian") {
            header_.encoding = PlyEncoding::little_endian;
        } else if (words_.size() >= 2 && words_[1] == "binary_big_endian") {
            header_.encoding = PlyEncoding::big_endian;
        } else {
            fail_at(source_, number_, "the format must be ascii, binary_little_endian or binary_big_endian");
        }
    }

    void parse_element() {
        const auto count = words_.size() == 3 ? parse_integer(words_[2]) : std::nullopt;
        if (!count || *count < 0) fail_at(source_, number_, "expected 'element NAME COUNT'");
        header_.elements.push_back({std::string(words_[1]), static_cast<std::uint64_t>(*count), {}});
    }

    void parse_property() {
        if (header_.elements.empty()) fail_at(source_, number_, "a property precedes the first element");
        PlyProperty property;
        if (words_.size() == 5 && words_[1] == "list") {
            property = {std::string(words_[4]), type(words_[3]), type(words_[2])};
            if (*property.count_type >= PlyType::float32)
                fail_at(source_, number_, "the length of a list must be an integer");
        } else if (words_.size() == 3) {
            property = {std::string(words_[2]), type(words_[1])};
        } else {
            fail_at(source_, number_, "expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
        }
        header_.elements.back().properties.push_back(std::move(property));
    }

    PlyType type(std::string_view name) const {
        for (const TypeName& t : kTypeNames) {
            if (t.name == name) return t.type;
        }
        fail_at(source_, number_, fmt::format("{} is not a PLY type", in_quotes(name)));
    }

    std::string_view file_;
    const std::string& source_;
    std::size_t offset_ = 0;
    std::size_t number_ = 0;
    std::string_view line_;
    std::vector<std::string_view> words_;
    PlyHeader header_;
};

template <class T>
double decode(const char* bytes, bool swap) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes, sizeof(T));
    if (swap) {
        for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(raw[i], raw[sizeof(T) - 1 - i]);
    }
    return static_cast<double>(std::bit_cast<T>(raw));
}

double decode(PlyType type, const char* bytes, bool swap) {
    switch (type) {
        case PlyType::int8:
            return decode<std::int8_t>(bytes, swap);
        case PlyType::uint8:
            return decode<std::uint8_t>(bytes, swap);
        case PlyType::int16:
            return decode<std::int16_t>(bytes, swap);
        case PlyType::uint16:
            return decode<std::uint16_t>(bytes, swap);
        case PlyType::int32:
            return decode<std::int32_t>(bytes, swap);
        case PlyType::uint32:
            return decode<std::uint32_t>(bytes, swap);
        case PlyType::float32:
            return decode<float>(bytes, swap);
        case PlyType::float64:
            return decode<double>(bytes, swap);
    }
    return 0;
}

bool separates(char c) { return is_blank(c) || c == '\n'; }

}  // namespace

std::size_t byte_size(PlyType type) {
    constexpr std::array<std::size_t, 8> kSize{1, 1, 2, 2, 4, 4, 4, 8};
    return kSize[static_cast<std::size_t>(type)];
}

std::optional<std::size_t> PlyElement::find(std::initializer_list<std::string_view> names) const {
    for (const std::string_view wanted : names) {
        for (std::size_t i = 0; i < properties.size(); ++i) {
            if (properties[i].name == wanted) return i;
        }
    }
    return std::nullopt;
}

bool PlyElement::has_list() const {
    for (const PlyProperty& property : properties) {
        if (property.is_list()) return true;
    }
    return false;
}

std::size_t PlyElement::min_row_bytes(PlyEncoding encoding) const {
    if (encoding == PlyEncoding::ascii) return 2 * properties.size();
    std::size_t bytes = 0;
    for (const PlyProperty& property : properties)
        bytes += byte_size(property.count_type.value_or(property.type));
    return bytes;
}

bool is_ply(std::string_view file) {
    return file.starts_with("ply") && file.size() > 3 && (file[3] == '\n' || is_blank(file[3]));
}

PlyHeader parse_ply_header(std::string_view file, const std::string& source) {
    return HeaderParser(file, source).parse();
}

PlyRows::PlyRows(std::string_view file, const PlyHeader& header, std::string source, const Context& ctx)
    : file_(file),
      encoding_(header.encoding),
      source_(std::move(source)),
      progress_(ctx, file.size()),
      offset_(header.data_offset) {}

void PlyRows::begin_element(const PlyElement& element) {
    element_ = &element;
    row_ = 0;
    const std::size_t least = element.min_row_bytes(encoding_);
    // The last number of an ASCII file may end without white space.
    const std::size_t left = file_.size() - offset_ + (encoding_ == PlyEncoding::ascii ? 1 : 0);
    if (least > 0 && element.count > left / least) {
        throw InvalidInput(
            fmt::format("{}: the header specifies {} rows of {}, but the file is too short for them; it is "
                        "truncated or damaged",
                        source_, element.count, in_quotes(element.name)));
    }
}

void PlyRows::read(PlyRow& row) {
    progress_.at(offset_);
    row.values.clear();
    row.first.clear();
    ++row_;
    for (const PlyProperty& property : element_->properties) {
        row.first.push_back(row.values.size());
        const std::size_t count = property.is_list() ? read_count(property) : 1;
        for (std::size_t i = 0; i < count; ++i) row.values.push_back(read_value(property.type));
    }
    row.first.push_back(row.values.size());
}

void PlyRows::skip_element() {
    if (encoding_ != PlyEncoding::ascii && !element_->has_list()) {
        take_fixed_rows();
        return;
    }
    PlyRow row;
    for (std::uint64_t i = 0; i < element_->count; ++i) read(row);
}

std::string_view PlyRows::take_fixed_rows() {
    COPPICE_ASSERT(encoding_ != PlyEncoding::ascii && !element_->has_list());
    const std::string_view rows = file_.substr(offset_, element_->count * element_->min_row_bytes(encoding_));
    offset_ += rows.size();
    return rows;
}

double PlyRows::read_value(PlyType type) {
    if (encoding_ == PlyEncoding::ascii) return read_ascii();
    const std::size_t bytes = byte_size(type);
    if (file_.size() - offset_ < bytes) fail("the file ends too early");
    const bool swap =
        (encoding_ == PlyEncoding::little_endian) != (std::endian::native == std::endian::little);
    const double value = decode(type, file_.data() + offset_, swap);
    offset_ += bytes;
    return value;
}

double PlyRows::read_ascii() {
    while (offset_ < file_.size() && separates(file_[offset_])) ++offset_;
    const std::size_t begin = offset_;
    while (offset_ < file_.size() && !separates(file_[offset_])) ++offset_;
    if (begin == offset_) fail("the file ends too early");
    const std::string_view token = file_.substr(begin, offset_ - begin);
    const std::optional<double> value = parse_number(token);
    if (!value) fail(fmt::format("{} is not a number", in_quotes(token)));
    return *value;
}

std::size_t PlyRows::read_count(const PlyProperty& property) {
    const double count = read_value(*property.count_type);
    const std::size_t item = encoding_ == PlyEncoding::ascii ? 2 : byte_size(property.type);
    const std::size_t most = (file_.size() - offset_ + 1) / item;
    if (!(count >= 0) || count > static_cast<double>(most) || count != std::trunc(count)) {
        fail(fmt::format("the list {} specifies {} items, more than the file can contain",
                         in_quotes(property.name), count));
    }
    return static_cast<std::size_t>(count);
}

void PlyRows::fail(const std::string& text) const {
    throw InvalidInput(fmt::format("{}: {} in row {} of {}", source_, text, row_, in_quotes(element_->name)));
}

}  // namespace coppice
