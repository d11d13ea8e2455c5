#include "coppice/io_xml/xml.h"

#include <expat.h>
#include <fmt/format.h>

#include <exception>
#include <memory>
#include <new>

#include "coppice/base/ascii.h"
#include "coppice/base/error.h"
#include "coppice/io/text.h"

namespace coppice::io_internal {
namespace {

/// Forwards the events of expat to a handler. Exceptions must not pass through expat, which is C: the first
/// is stored and rethrown after expat has stopped.
class XmlEvents {
  public:
    XmlEvents(XmlHandler& handler, std::string_view format, const std::string& source)
        : handler_(handler),
          format_(format),
          source_(source),
          parser_(XML_ParserCreate(nullptr), XML_ParserFree) {
        if (!parser_) throw std::bad_alloc();
        XML_SetUserData(parser_.get(), this);
        XML_SetElementHandler(parser_.get(), on_start, on_end);
        XML_SetCharacterDataHandler(parser_.get(), on_text);
        XML_SetEntityDeclHandler(parser_.get(), on_entity);
        XML_SetUnknownEncodingHandler(parser_.get(), on_encoding, nullptr);
    }

    void parse(std::string_view text) {
        constexpr std::size_t kMax = 1 << 30;  // expat counts bytes in int
        do {
            const std::string_view part = text.substr(0, kMax);
            text.remove_prefix(part.size());
            const auto status = XML_Parse(parser_.get(), part.data(), static_cast<int>(part.size()),
                                          text.empty() ? XML_TRUE : XML_FALSE);
            if (error_) std::rethrow_exception(error_);
            if (status != XML_STATUS_OK) fail_as_expat_says();
        } while (!text.empty());
    }

  private:
    std::uint32_t line() const { return static_cast<std::uint32_t>(XML_GetCurrentLineNumber(parser_.get())); }

    [[noreturn]] void fail_as_expat_says() const {
        const XML_Error code = XML_GetErrorCode(parser_.get());
        if (code == XML_ERROR_NO_MEMORY) throw std::bad_alloc();
        fail_at(source_, line(), fmt::format("this is not valid XML: {}", XML_ErrorString(code)));
    }

    template <class Action>
    static void guarded(void* data, const Action& action) {
        XmlEvents& events = *static_cast<XmlEvents*>(data);
        if (events.error_) return;
        try {
            action(events);
        } catch (...) {
            events.error_ = std::current_exception();
            XML_StopParser(events.parser_.get(), XML_FALSE);
        }
    }

    static void XMLCALL on_start(void* data, const XML_Char* name, const XML_Char** attributes) {
        guarded(data, [&](XmlEvents& events) {
            const auto byte = static_cast<std::uint64_t>(XML_GetCurrentByteIndex(events.parser_.get()));
            events.handler_.start(name, XmlAttributes(attributes), {events.line(), byte});
        });
    }
    static void XMLCALL on_end(void* data, const XML_Char*) {
        guarded(data, [](XmlEvents& events) { events.handler_.end(); });
    }
    static void XMLCALL on_text(void* data, const XML_Char* text, int size) {
        guarded(data, [&](XmlEvents& events) {
            events.handler_.text({text, static_cast<std::size_t>(size)});
        });
    }
    /// Refuses entities: nested ones can expand a few lines to gigabytes.
    static void XMLCALL on_entity(void* data, const XML_Char*, int, const XML_Char*, int, const XML_Char*,
                                  const XML_Char*, const XML_Char*, const XML_Char*) {
        guarded(data, [](XmlEvents& events) {
            fail_at(
                events.source_, events.line(),
                fmt::format("the DOCTYPE declares entities, which {} does not use; remove the declaration",
                            events.format_));
        });
    }
    /// Reads the encodings Windows-125x and ISO 8859 as Latin-1: names and numbers are ASCII in all of them,
    /// and other letters occur only in labels, which are ignored.
    static int XMLCALL on_encoding(void*, const XML_Char* name, XML_Encoding* encoding) {
        const std::string simple = to_lower(name);
        if (!simple.starts_with("windows-125") && !simple.starts_with("cp125") &&
            !simple.starts_with("iso-8859"))
            return XML_STATUS_ERROR;
        for (int i = 0; i < 256; ++i) encoding->map[i] = i;
        encoding->data = nullptr;
        encoding->convert = nullptr;
        encoding->release = nullptr;
        return XML_STATUS_OK;
    }

    XmlHandler& handler_;
    std::string_view format_;
    const std::string& source_;
    std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser_;
    std::exception_ptr error_;
};

}  // namespace

std::string_view XmlAttributes::trimmed_value(std::string_view value) { return trimmed(value); }

void parse_xml(std::string_view document, std::string_view format, const std::string& source,
               XmlHandler& handler) {
    XmlEvents(handler, format, source).parse(document);
}

}  // namespace coppice::io_internal
