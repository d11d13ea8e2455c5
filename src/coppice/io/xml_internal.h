#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace coppice::io_internal {

/// Names and values of an element, as expat hands them over.
class XmlAttributes {
  public:
    explicit XmlAttributes(const char* const* list) : list_(list) {}

    /// The trimmed value of the first attribute for whose name is_it(name) holds.
    template <class IsIt>
    std::optional<std::string_view> find_if(const IsIt& is_it) const {
        for (const char* const* at = list_; *at != nullptr; at += 2)
            if (is_it(std::string_view(*at))) return trimmed_value(at[1]);
        return std::nullopt;
    }
    std::optional<std::string_view> find(std::string_view name) const {
        return find_if([&](std::string_view other) { return other == name; });
    }

  private:
    static std::string_view trimmed_value(std::string_view value);

    const char* const* list_;
};

/// Where in a document an element begins.
struct XmlPlace {
    std::uint32_t line = 0;  ///< from 1
    std::uint64_t byte = 0;
};

/// Takes what a document says, as it comes. What these throw ends the parsing.
class XmlHandler {
  public:
    virtual ~XmlHandler() = default;
    virtual void start(std::string_view name, const XmlAttributes& attributes, const XmlPlace& place) = 0;
    virtual void text(std::string_view text) = 0;  ///< a part of it, maybe
    virtual void end() = 0;                        ///< of the element that was begun last
};

/// Parses XML from one event to the next: nothing is kept, nothing recurses, no file is opened. Names of
/// encodings of one byte are known. Throws InvalidInput where it is no XML, and where it declares entities,
/// by which a few lines can grow to gigabytes; `format` is the one that needs none.
void parse_xml(std::string_view document, std::string_view format, const std::string& source,
               XmlHandler& handler);

}  // namespace coppice::io_internal
