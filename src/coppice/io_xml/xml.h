#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace coppice::io_internal {

/// Attributes of an element as passed by expat.
class XmlAttributes {
  public:
    explicit XmlAttributes(const char* const* list) : list_(list) {}

    /// Returns the trimmed value of the first attribute that satisfies is_it(name).
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

/// Position of an element in a document.
struct XmlPlace {
    std::uint32_t line = 0;  ///< from 1
    std::uint64_t byte = 0;
};

/// Receives the events of a parser in document order. Exceptions thrown by its functions end the parsing.
class XmlHandler {
  public:
    virtual ~XmlHandler() = default;
    virtual void start(std::string_view name, const XmlAttributes& attributes, const XmlPlace& place) = 0;
    virtual void text(std::string_view text) = 0;  ///< possibly only a part of a text
    virtual void end() = 0;                        ///< end of the current element
};

/// Parses XML event by event, without storing the document, without recursion and without opening files.
/// Supports the encodings Windows-125x and ISO 8859 too. Throws InvalidInput if it is not valid XML or
/// declares entities, which can expand a few lines to gigabytes; `format` names the format in messages.
void parse_xml(std::string_view document, std::string_view format, const std::string& source,
               XmlHandler& handler);

}  // namespace coppice::io_internal
