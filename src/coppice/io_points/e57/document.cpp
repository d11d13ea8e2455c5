#include "coppice/io_points/e57/document_internal.h"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <limits>
#include <optional>

#include "coppice/base/error.h"
#include "coppice/io/text.h"
#include "coppice/io_xml/xml.h"

namespace coppice::e57 {
namespace {

using io_internal::XmlAttributes;
using io_internal::XmlPlace;

constexpr std::string_view kScan = "/e57Root/data3D/vectorChild";

class Reader : public io_internal::XmlHandler {
  public:
    explicit Reader(const std::string& source) : source_(source) {}

    void start(std::string_view name, const XmlAttributes& attributes, const XmlPlace& place) override {
        lengths_.push_back(path_.size());
        path_.append(1, '/').append(name);
        text_.clear();
        line_ = place.line;
        if (path_ == kScan) document_.scans.emplace_back();
        const std::string_view within = within_scan();
        if (within == "/points") begin_points(attributes);
        constexpr std::string_view kPrototype = "/points/prototype/";
        if (within.starts_with(kPrototype)) add_field(within.substr(kPrototype.size()), attributes);
    }

    void text(std::string_view text) override {
        constexpr std::size_t kLongest = 65535;  // maximum size of WKT in LAS
        if (text_.size() < kLongest) text_ += text.substr(0, kLongest);
    }

    void end() override {
        finish();
        path_.resize(lengths_.back());
        lengths_.pop_back();
        text_.clear();
    }

    Document take() { return std::move(document_); }

  private:
    /// Returns the path relative to the current scan; empty outside scans.
    std::string_view within_scan() const {
        const std::string_view path = path_;
        return path.starts_with(kScan) && path.size() > kScan.size() && path[kScan.size()] == '/'
                   ? path.substr(kScan.size())
                   : std::string_view();
    }

    void begin_points(const XmlAttributes& attributes) {
        Scan& scan = document_.scans.back();
        scan.has_points = true;
        scan.offset = whole(attributes, "fileOffset");
        scan.count = whole(attributes, "recordCount");
    }

    void add_field(std::string_view name, const XmlAttributes& attributes) {
        constexpr std::size_t kMaxFields = 1000;
        std::vector<Field>& fields = document_.scans.back().fields;
        const std::string type(attributes.find("type").value_or(""));
        if (fields.size() == kMaxFields) fail(fmt::format("points have more than {} fields", kMaxFields));
        Field field{.name = std::string(name)};
        if (type == "Float") {
            const bool single = attributes.find("precision").value_or("double") == "single";
            field.type = single ? Field::Type::float32 : Field::Type::float64;
            field.bits = single ? 32 : 64;
        } else if (type == "Integer" || type == "ScaledInteger") {
            set_range(field, attributes);
            if (type == "ScaledInteger") {
                field.scale = real(attributes.find("scale").value_or("1"));
                field.offset = real(attributes.find("offset").value_or("0"));
            }
        } else {
            fail(fmt::format("the field {} of points is of type {}, which cannot be read", in_quotes(name),
                             in_quotes(type)));
        }
        fields.push_back(std::move(field));
    }

    void set_range(Field& field, const XmlAttributes& attributes) const {
        const std::int64_t low = integer(attributes, "minimum", std::numeric_limits<std::int64_t>::min());
        const std::int64_t high = integer(attributes, "maximum", std::numeric_limits<std::int64_t>::max());
        if (high < low) fail(fmt::format("the range of the field {} is empty", in_quotes(field.name)));
        field.minimum = static_cast<std::uint64_t>(low);
        field.bits = static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(high) - field.minimum));
    }

    void finish() {
        if (path_ == "/e57Root/coordinateMetadata") document_.system = trimmed(text_);
        const std::string_view within = within_scan();
        if (within.empty()) return;
        Scan& scan = document_.scans.back();
        constexpr std::array<std::string_view, 4> kRotation{"/pose/rotation/w", "/pose/rotation/x",
                                                            "/pose/rotation/y", "/pose/rotation/z"};
        for (std::size_t i = 0; i < kRotation.size(); ++i)
            if (within == kRotation[i]) scan.rotation[i] = number();
        if (within == "/pose/translation/x") scan.translation.x = number();
        if (within == "/pose/translation/y") scan.translation.y = number();
        if (within == "/pose/translation/z") scan.translation.z = number();
        constexpr std::array<std::string_view, 3> kColors{"/colorLimits/colorRedMaximum",
                                                          "/colorLimits/colorGreenMaximum",
                                                          "/colorLimits/colorBlueMaximum"};
        for (std::size_t i = 0; i < kColors.size(); ++i)
            if (within == kColors[i]) scan.max_color[i] = number();
    }

    /// Returns the number in the element; 0 if it is empty.
    double number() const {
        const std::string_view text = trimmed(text_);
        return text.empty() ? 0 : real(text);
    }
    double real(std::string_view text) const {
        const auto value = parse_number(text);
        if (!value || !(*value - *value == 0)) fail(fmt::format("{} is not a number", in_quotes(text)));
        return *value;
    }
    std::int64_t integer(const XmlAttributes& attributes, std::string_view name,
                         std::int64_t otherwise) const {
        const auto text = attributes.find(name);
        if (!text) return otherwise;
        std::int64_t value = 0;
        const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
        if (error != std::errc() || end != text->data() + text->size())
            fail(fmt::format("the {} is {}, which is not an integer", name, in_quotes(*text)));
        return value;
    }
    std::uint64_t whole(const XmlAttributes& attributes, std::string_view name) const {
        const std::int64_t value = integer(attributes, name, -1);
        if (value < 0) fail(fmt::format("the points of a scan have no {}", name));
        return static_cast<std::uint64_t>(value);
    }
    [[noreturn]] void fail(const std::string& text) const {
        throw InvalidInput(fmt::format("{}: line {} of its XML: {}", source_, line_, text));
    }

    const std::string& source_;
    Document document_;
    std::string path_;
    std::vector<std::size_t> lengths_;  // length of the path before each open element
    std::string text_;
    std::uint32_t line_ = 0;
};

}  // namespace

Document parse_document(std::string_view xml, const std::string& source) {
    Reader reader(source);
    io_internal::parse_xml(xml, "E57", source, reader);
    return reader.take();
}

}  // namespace coppice::e57
