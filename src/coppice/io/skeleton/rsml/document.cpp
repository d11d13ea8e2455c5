#include "coppice/io/skeleton/rsml/document_internal.h"

#include <expat.h>

#include <algorithm>
#include <array>
#include <exception>
#include <map>
#include <memory>
#include <new>
#include <optional>

#include <fmt/format.h>

#include "coppice/base/ascii.h"
#include "coppice/base/error.h"
#include "coppice/io/file_progress.h"
#include "coppice/io/text_internal.h"

namespace coppice::rsml {

namespace {

/// Elements that mean something where they stand.
enum class Element : std::uint8_t {
    document,
    rsml,
    metadata,
    unit,
    resolution,
    software,
    scene,
    plant,
    root,
    geometry,
    polyline,
    point,
    functions,
    function,
    sample,
    properties,
    parent_node,
    diameter,
    radius,
    other
};

struct Place {
    Element parent;
    std::string_view name;
    Element element;
};

constexpr std::array kPlaces{Place{Element::document, "rsml", Element::rsml},
                             Place{Element::rsml, "metadata", Element::metadata},
                             Place{Element::rsml, "scene", Element::scene},
                             Place{Element::metadata, "unit", Element::unit},
                             Place{Element::metadata, "resolution", Element::resolution},
                             Place{Element::metadata, "software", Element::software},
                             Place{Element::scene, "plant", Element::plant},
                             Place{Element::scene, "root", Element::root},
                             Place{Element::plant, "root", Element::root},
                             Place{Element::root, "root", Element::root},
                             Place{Element::root, "geometry", Element::geometry},
                             Place{Element::root, "functions", Element::functions},
                             Place{Element::root, "properties", Element::properties},
                             Place{Element::geometry, "polyline", Element::polyline},
                             Place{Element::polyline, "point", Element::point},
                             Place{Element::functions, "function", Element::function},
                             Place{Element::function, "sample", Element::sample},
                             Place{Element::properties, "parent_node", Element::parent_node},
                             Place{Element::properties, "diameter", Element::diameter},
                             Place{Element::properties, "radius", Element::radius}};

/// "po:Parent-Node" gives "parent_node".
std::string simple_name(std::string_view name) {
    name.remove_prefix(name.find(':') == name.npos ? 0 : name.find(':') + 1);
    std::string simple = to_lower(name);
    std::ranges::replace_if(
        simple, [](char c) { return c == '-' || c == ' '; }, '_');
    return simple;
}

Element element_of(Element parent, std::string_view name) {
    const std::string simple = simple_name(name);
    const auto place =
        std::ranges::find_if(kPlaces, [&](const Place& p) { return p.parent == parent && p.name == simple; });
    return place == kPlaces.end() ? Element::other : place->element;
}

/// Names and values of an element, as expat hands them over.
class Attributes {
  public:
    explicit Attributes(const XML_Char** list) : list_(list) {}

    std::optional<std::string_view> find(std::string_view name) const {
        for (const XML_Char** at = list_; *at != nullptr; at += 2) {
            if (simple_name(*at) == name) return trimmed(at[1]);
        }
        return std::nullopt;
    }

  private:
    const XML_Char** list_;
};

class DocumentBuilder {
  public:
    DocumentBuilder(std::uint64_t size, const std::string& source, const Context& ctx)
        : source_(source), progress_(ctx, size) {}

    void start(std::string_view name, const Attributes& attributes, std::uint32_t line, std::uint64_t byte) {
        progress_.at(byte);
        line_ = line;
        Element element = element_of(open_.back(), name);
        if (open_.size() == 1 && element != Element::rsml) {
            fail(fmt::format("this XML is no RSML: it starts with {}", in_quotes(name)));
        }
        // Of several lines of a root the first counts.
        if (element == Element::polyline && document_.roots[roots_.back()].point_count > 0)
            element = Element::other;
        open_.push_back(element);
        begin(element, attributes);
    }

    void text(std::string_view text) {
        constexpr std::size_t kLongest = 4096;
        if (text_.size() < kLongest) text_ += text.substr(0, kLongest);
    }

    void end() {
        finish(open_.back());
        open_.pop_back();
        text_.clear();
    }

    Document take() { return std::move(document_); }

  private:
    void begin(Element element, const Attributes& attributes) {
        if (element == Element::plant) {
            ++plants_;
        } else if (element == Element::root) {
            begin_root();
        } else if (element == Element::polyline) {
            document_.roots[roots_.back()].first_point = static_cast<std::uint32_t>(document_.points.size());
        } else if (element == Element::point) {
            add_point(attributes);
        } else if (element == Element::function) {
            begin_function(attributes);
        } else if (element == Element::sample) {
            begin_sample(attributes);
        }
        text_ = attributes.find("value").value_or("");
    }

    void finish(Element element) {
        const std::string_view text = trimmed(text_);
        if (element == Element::unit) document_.unit = text;
        if (element == Element::software) document_.software = text;
        if (element == Element::resolution) document_.resolution = number(text);
        if (element == Element::root) roots_.pop_back();
        if (element == Element::parent_node) document_.roots[roots_.back()].parent_node = number(text);
        if (element == Element::diameter) document_.roots[roots_.back()].diameter = number(text);
        if (element == Element::radius) document_.roots[roots_.back()].diameter = 2 * number(text);
        if (element == Element::sample) document_.samples.back().value = number(text);
    }

    void begin_root() {
        Root root;
        root.parent = roots_.empty() ? kNone : roots_.back();
        root.plant = plants_ == 0 ? 0 : plants_ - 1;
        root.order = static_cast<std::uint32_t>(roots_.size());
        root.line = line_;
        roots_.push_back(static_cast<std::uint32_t>(document_.roots.size()));
        document_.roots.push_back(root);
    }

    void add_point(const Attributes& attributes) {
        const Vec3d point{coordinate(attributes, "x"), coordinate(attributes, "y"),
                          attributes.find("z") ? coordinate(attributes, "z") : 0};
        if (point.z != 0) document_.is_flat = false;
        document_.points.push_back(point);
        document_.lines.push_back(line_);
        ++document_.roots[roots_.back()].point_count;
    }

    double coordinate(const Attributes& attributes, std::string_view name) const {
        const auto text = attributes.find(name);
        if (!text) fail(fmt::format("a point has no {}", name));
        const auto value = parse_number(*text);
        if (!value) fail(fmt::format("the {} of a point is {}, which is no number", name, in_quotes(*text)));
        return *value;
    }

    void begin_function(const Attributes& attributes) {
        Function function;
        function.root = roots_.back();
        const std::string domain = simple_name(attributes.find("domain").value_or("polyline"));
        function.domain = domain == "uniform"  ? Domain::uniform
                          : domain == "length" ? Domain::length
                                               : Domain::polyline;
        function.from_tip = simple_name(attributes.find("origin").value_or("base")) == "tip";
        function.name = name_index(simple_name(attributes.find("name").value_or("")));
        function.first_sample = static_cast<std::uint32_t>(document_.samples.size());
        document_.functions.push_back(function);
    }

    void begin_sample(const Attributes& attributes) {
        document_.samples.push_back({kUnknown, number(attributes.find("position").value_or(""))});
        ++document_.functions.back().sample_count;
    }

    std::uint32_t name_index(const std::string& name) {
        const auto [at, is_new] = names_.try_emplace(name, static_cast<std::uint32_t>(names_.size()));
        if (is_new) document_.names.push_back(name);
        return at->second;
    }

    static double number(std::string_view text) { return parse_number(text).value_or(kUnknown); }

    [[noreturn]] void fail(const std::string& text) const { fail_at(source_, line_, text); }

    const std::string& source_;
    FileProgress progress_;
    Document document_;
    std::vector<Element> open_{Element::document};
    std::vector<std::uint32_t> roots_;  // the open ones
    std::map<std::string, std::uint32_t> names_;
    std::string text_;
    std::uint32_t plants_ = 0;
    std::uint32_t line_ = 0;
};

/// Expat's events for a builder. No exception may pass through expat, which is C: it is kept, and thrown when
/// expat has stopped.
class XmlEvents {
  public:
    XmlEvents(DocumentBuilder& builder, const std::string& source)
        : builder_(builder), source_(source), parser_(XML_ParserCreate(nullptr), XML_ParserFree) {
        if (!parser_) throw std::bad_alloc();
        XML_SetUserData(parser_.get(), this);
        XML_SetElementHandler(parser_.get(), on_start, on_end);
        XML_SetCharacterDataHandler(parser_.get(), on_text);
        XML_SetEntityDeclHandler(parser_.get(), on_entity);
        XML_SetUnknownEncodingHandler(parser_.get(), on_encoding, nullptr);
    }

    void parse(std::string_view text) {
        constexpr std::size_t kMost = 1 << 30;  // expat counts in int
        do {
            const std::string_view part = text.substr(0, kMost);
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
            events.builder_.start(name, Attributes(attributes), events.line(), byte);
        });
    }
    static void XMLCALL on_end(void* data, const XML_Char*) {
        guarded(data, [](XmlEvents& events) { events.builder_.end(); });
    }
    static void XMLCALL on_text(void* data, const XML_Char* text, int size) {
        guarded(data, [&](XmlEvents& events) {
            events.builder_.text({text, static_cast<std::size_t>(size)});
        });
    }
    /// Entities made of entities can grow a few lines to gigabytes.
    static void XMLCALL on_entity(void* data, const XML_Char*, int, const XML_Char*, int, const XML_Char*,
                                  const XML_Char*, const XML_Char*, const XML_Char*) {
        guarded(data, [](XmlEvents& events) {
            fail_at(events.source_, events.line(),
                    "the DOCTYPE declares entities, which RSML has no need of; take the declaration out");
        });
    }
    /// Names and numbers are ASCII in all encodings of one byte that programs write; other letters stand in
    /// labels, which do not matter here.
    static int XMLCALL on_encoding(void*, const XML_Char* name, XML_Encoding* encoding) {
        const std::string simple = simple_name(name);
        if (!simple.starts_with("windows_125") && !simple.starts_with("cp125") &&
            !simple.starts_with("iso_8859"))
            return XML_STATUS_ERROR;
        for (int i = 0; i < 256; ++i) encoding->map[i] = i;
        encoding->data = nullptr;
        encoding->convert = nullptr;
        encoding->release = nullptr;
        return XML_STATUS_OK;
    }

    DocumentBuilder& builder_;
    const std::string& source_;
    std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser_;
    std::exception_ptr error_;
};

}  // namespace

Document parse_document(std::string_view text, const std::string& source, const Context& ctx) {
    DocumentBuilder builder(text.size(), source, ctx);
    XmlEvents(builder, source).parse(text);
    return builder.take();
}

}  // namespace coppice::rsml
