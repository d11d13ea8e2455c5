#define ZLIB_CONST
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/io_skeleton/cylinders/mat_file_internal.h"

namespace coppice {

namespace {

constexpr std::size_t kHeaderBytes = 128;
constexpr int kDeepest = 8;
constexpr std::size_t kMaxItems = 1000000;

/// Types of data elements and classes of arrays, numbered as in the format.
enum Type : std::uint32_t {
    kInt8 = 1,
    kUint8 = 2,
    kInt16 = 3,
    kUint16 = 4,
    kInt32 = 5,
    kUint32 = 6,
    kSingle = 7,
    kDouble = 9,
    kInt64 = 12,
    kUint64 = 13,
    kMatrix = 14,
    kCompressed = 15
};
enum Class : std::uint32_t { kCell = 1, kStruct = 2, kFirstNumeric = 6, kLastNumeric = 15 };

std::size_t get_size(std::uint32_t type) {
    switch (type) {
        case kInt8:
        case kUint8:
            return 1;
        case kInt16:
        case kUint16:
            return 2;
        case kInt32:
        case kUint32:
        case kSingle:
            return 4;
        case kDouble:
        case kInt64:
        case kUint64:
            return 8;
        default:
            return 0;
    }
}

template <class T>
T load(const char* bytes, bool swapped) {
    char raw[sizeof(T)];
    std::memcpy(raw, bytes, sizeof(T));
    if (swapped) std::reverse(raw, raw + sizeof(T));
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return value;
}

double load_number(std::uint32_t type, const char* bytes, bool swapped) {
    switch (type) {
        case kInt8:
            return load<std::int8_t>(bytes, swapped);
        case kUint8:
            return load<std::uint8_t>(bytes, swapped);
        case kInt16:
            return load<std::int16_t>(bytes, swapped);
        case kUint16:
            return load<std::uint16_t>(bytes, swapped);
        case kInt32:
            return load<std::int32_t>(bytes, swapped);
        case kUint32:
            return load<std::uint32_t>(bytes, swapped);
        case kSingle:
            return static_cast<double>(load<float>(bytes, swapped));
        case kDouble:
            return load<double>(bytes, swapped);
        case kInt64:
            return static_cast<double>(load<std::int64_t>(bytes, swapped));
        case kUint64:
            return static_cast<double>(load<std::uint64_t>(bytes, swapped));
        default:
            return 0;
    }
}

struct Element {
    std::uint32_t type = 0;
    std::string_view data;
};

class Parser {
  public:
    Parser(std::string_view file, const std::string& source, std::deque<std::string>& unpacked,
           const Context& ctx)
        : ctx_(ctx),
          file_(file),
          source_(source),
          unpacked_(unpacked),
          bytes_left_((std::size_t{64} << 20) + 20 * file.size()) {}

    std::vector<MatArray> parse() {
        read_head();
        std::vector<MatArray> variables;
        std::string_view rest = file_.substr(kHeaderBytes);
        while (!rest.empty()) {
            Element element = take(rest);
            if (element.type == kCompressed) {
                std::string_view unpacked = unpack(element.data);
                element = take(unpacked);
            }
            if (element.type == kMatrix) variables.push_back(array(element.data, 0));
        }
        return variables;
    }

  private:
    void read_head() {
        if (file_.starts_with("MATLAB 7.3") || file_.starts_with("\x89HDF")) {
            throw Unsupported(fmt::format(
                "{}: MATLAB files of version 7.3 are not read; save it again with '-v7'", source_));
        }
        if (file_.size() < kHeaderBytes) fail("not a MATLAB file of level 5, or truncated");
        const std::string_view order = file_.substr(126, 2);
        constexpr bool kLittle = std::endian::native == std::endian::little;
        if (order != "IM" && order != "MI") fail("not a MATLAB file of level 5; save it again with '-v7'");
        swapped_ = (order == "IM") != kLittle;
    }

    std::uint32_t word(std::string_view bytes, std::size_t index) const {
        if (bytes.size() < 4 * index + 4) fail_damaged();
        return load<std::uint32_t>(bytes.data() + 4 * index, swapped_);
    }

    /// Reads the next data element: a type, a length and data, or all of it in 8 bytes if the data have at
    /// most 4.
    Element take(std::string_view& rest) const {
        const std::uint32_t first = word(rest, 0), small_size = first >> 16;
        if (small_size != 0) {
            if (small_size > 4 || rest.size() < 8) fail_damaged();
            const Element element{first & 0xffff, rest.substr(4, small_size)};
            rest.remove_prefix(8);
            return element;
        }
        const std::size_t size = word(rest, 1);
        if (size > rest.size() - 8) fail_damaged();
        const Element element{first, rest.substr(8, size)};
        const std::size_t padded = first == kCompressed ? size : (size + 7) / 8 * 8;
        rest.remove_prefix(std::min(rest.size(), 8 + padded));
        return element;
    }

    std::string_view unpack(std::string_view packed) {
        constexpr std::size_t kStep = std::size_t{1} << 16;
        std::string& out = unpacked_.emplace_back();
        z_stream stream{};
        if (inflateInit(&stream) != Z_OK) fail_damaged();
        const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
        stream.next_in = reinterpret_cast<const Bytef*>(packed.data());
        stream.avail_in = static_cast<uInt>(packed.size());
        int status = Z_OK;
        std::size_t used = 0;
        while (status == Z_OK && used <= bytes_left_) {
            ctx_.throw_if_cancelled();
            out.resize(used + kStep);
            stream.next_out = reinterpret_cast<Bytef*>(out.data() + used);
            stream.avail_out = static_cast<uInt>(kStep);
            status = inflate(&stream, Z_NO_FLUSH);
            used += kStep - stream.avail_out;
        }
        if (used > bytes_left_)
            fail("a variable decompresses to more data than is plausible for the size of the file");
        if (status != Z_STREAM_END) fail_damaged();
        bytes_left_ -= used;
        out.resize(used);
        return out;
    }

    MatArray array(std::string_view rest, int depth) {
        if (depth > kDeepest) fail("structures are nested too deeply");
        ctx_.throw_if_cancelled();
        if (items_left_-- == 0) fail("there are more fields than is plausible");
        MatArray result;
        if (rest.empty()) return result;  // the encoding of an empty field
        const std::uint32_t flags = word(take(rest).data, 0);
        const std::uint32_t kind = flags & 0xff;
        const bool numeric = kind >= kFirstNumeric && kind <= kLastNumeric;
        if (!numeric && kind != kStruct && kind != kCell) return result;

        read_dims(take(rest).data, result);
        result.name = take(rest).data;
        result.complex = (flags & 0x800) != 0;
        result.swapped = swapped_;
        if (numeric) {
            result.kind = MatArray::Kind::numbers;
            const Element numbers = take(rest);
            result.type = numbers.type;
            result.data = numbers.data;
            return result;
        }
        result.kind = kind == kStruct ? MatArray::Kind::structure : MatArray::Kind::cell;
        if (kind == kStruct) read_fields(rest, result);
        read_items(rest, result, depth);
        return result;
    }

    void read_dims(std::string_view dims, MatArray& result) const {
        // Each item needs at least a byte of the file or of its decompressed data.
        const std::size_t most = bytes_left_ + file_.size() + (std::size_t{64} << 20);
        std::size_t count = 1;
        for (std::size_t i = 0; i < dims.size() / 4; ++i) {
            const std::size_t size = word(dims, i);
            if (size > std::numeric_limits<std::int32_t>::max()) fail_damaged();
            result.dims.push_back(size);
            if (size > 0 && count > most / size) fail_damaged();
            count *= size;
        }
    }

    void read_fields(std::string_view& rest, MatArray& result) const {
        const std::size_t length = word(take(rest).data, 0);
        const std::string_view names = take(rest).data;
        if (length == 0) fail_damaged();
        for (std::size_t i = 0; i + length <= names.size(); i += length) {
            const std::string_view name = names.substr(i, length);
            result.fields.emplace_back(name.substr(0, name.find('\0')));
        }
    }

    void read_items(std::string_view rest, MatArray& result, int depth) {
        const std::size_t per_element = result.kind == MatArray::Kind::structure ? result.fields.size() : 1;
        if (per_element == 0) return;
        // An item needs at least 8 bytes.
        if (result.count() > rest.size() / 8 / per_element) fail_damaged();
        const std::size_t count = result.count() * per_element;
        result.items.reserve(std::min(count, items_left_));
        for (std::size_t i = 0; i < count; ++i) {
            const Element item = take(rest);
            if (item.type != kMatrix) fail_damaged();
            result.items.push_back(array(item.data, depth + 1));
            if (!result.fields.empty()) result.items.back().name = result.fields[i % per_element];
        }
    }

    [[noreturn]] void fail(std::string_view text) const {
        throw InvalidInput(fmt::format("{}: {}", source_, text));
    }
    [[noreturn]] void fail_damaged() const { fail("the MATLAB file is truncated or damaged"); }

    const Context& ctx_;
    std::string_view file_;
    const std::string& source_;
    std::deque<std::string>& unpacked_;
    std::size_t bytes_left_;  ///< remaining size that compressed variables may decompress to
    std::size_t items_left_ = kMaxItems;
    bool swapped_ = false;
};

}  // namespace

std::size_t MatArray::count() const {
    std::size_t product = dims.empty() ? 0 : 1;
    for (const std::size_t size : dims) product *= size;
    return product;
}

std::optional<std::vector<double>> MatArray::numbers() const {
    const std::size_t size = get_size(type);
    if (kind != Kind::numbers || complex || size == 0 || data.size() / size < count()) return std::nullopt;
    std::vector<double> values(count());
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = load_number(type, data.data() + i * size, swapped);
    return values;
}

MatFile::MatFile(std::string_view bytes, const std::string& source, const Context& ctx)
    : variables_(Parser(bytes, source, unpacked_, ctx).parse()) {}

}  // namespace coppice
