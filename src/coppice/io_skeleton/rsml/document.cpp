#include "coppice/io_skeleton/rsml/document_internal.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "coppice/base/ascii.h"
#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/io/text.h"
#include "coppice/io_xml/xml.h"
#include "coppice/system/file_progress.h"

namespace coppice::rsml {

namespace {

using io_internal::XmlAttributes;
using io_internal::XmlPlace;

/// Elements that are interpreted, depending on their context.
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

/// Normalizes a name: "po:Parent-Node" to "parent_node".
std::string simple_name(std::string_view name) {
    name.remove_prefix(name.find(':') == name.npos ? 0 : name.find(':') + 1);
    std::string simple = to_lower(name);
    std::ranges::replace_if(
        simple, [](char c) { return c == '-' || c == ' '; }, '_');
    return simple;
}

Element find_element(Element parent, std::string_view name) {
    const std::string simple = simple_name(name);
    const auto place =
        std::ranges::find_if(kPlaces, [&](const Place& p) { return p.parent == parent && p.name == simple; });
    return place == kPlaces.end() ? Element::other : place->element;
}

std::optional<std::string_view> find(const io_internal::XmlAttributes& attributes, std::string_view name) {
    return attributes.find_if([&](std::string_view other) { return simple_name(other) == name; });
}

class DocumentBuilder : public io_internal::XmlHandler {
  public:
    DocumentBuilder(std::uint64_t size, const std::string& source, const Context& ctx)
        : source_(source), progress_(ctx, size) {}

    void start(std::string_view name, const XmlAttributes& attributes, const XmlPlace& place) override {
        progress_.at(place.byte);
        line_ = place.line;
        Element element = find_element(open_.back(), name);
        if (open_.size() == 1 && element != Element::rsml) {
            fail(fmt::format("this XML is not RSML: it starts with {}", in_quotes(name)));
        }
        // The first of several polylines of a root is used.
        if (element == Element::polyline && document_.roots[roots_.back()].point_count > 0)
            element = Element::other;
        open_.push_back(element);
        begin(element, attributes);
    }

    void text(std::string_view text) override {
        constexpr std::size_t kLongest = 4096;
        if (text_.size() < kLongest) text_ += text.substr(0, kLongest);
    }

    void end() override {
        finish(open_.back());
        open_.pop_back();
        text_.clear();
    }

    Document take() { return std::move(document_); }

  private:
    void begin(Element element, const XmlAttributes& attributes) {
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
        text_ = find(attributes, "value").value_or("");
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
        root.parent = roots_.empty() ? kNoIndex : roots_.back();
        root.plant = plants_ == 0 ? 0 : plants_ - 1;
        root.order = static_cast<std::uint32_t>(roots_.size());
        root.line = line_;
        roots_.push_back(static_cast<std::uint32_t>(document_.roots.size()));
        document_.roots.push_back(root);
    }

    void add_point(const XmlAttributes& attributes) {
        const Vec3d point{coordinate(attributes, "x"), coordinate(attributes, "y"),
                          find(attributes, "z") ? coordinate(attributes, "z") : 0};
        if (point.z != 0) document_.is_flat = false;
        document_.points.push_back(point);
        document_.lines.push_back(line_);
        ++document_.roots[roots_.back()].point_count;
    }

    double coordinate(const XmlAttributes& attributes, std::string_view name) const {
        const auto text = find(attributes, name);
        if (!text) fail(fmt::format("a point has no {}", name));
        const auto value = parse_number(*text);
        if (!value)
            fail(fmt::format("the {} of a point is {}, which is not a number", name, in_quotes(*text)));
        return *value;
    }

    void begin_function(const XmlAttributes& attributes) {
        Function function;
        function.root = roots_.back();
        const std::string domain = simple_name(find(attributes, "domain").value_or("polyline"));
        function.domain = domain == "uniform"  ? Domain::uniform
                          : domain == "length" ? Domain::length
                                               : Domain::polyline;
        function.from_tip = simple_name(find(attributes, "origin").value_or("base")) == "tip";
        function.name = name_index(simple_name(find(attributes, "name").value_or("")));
        function.first_sample = static_cast<std::uint32_t>(document_.samples.size());
        document_.functions.push_back(function);
    }

    void begin_sample(const XmlAttributes& attributes) {
        document_.samples.push_back({kUnknown, number(find(attributes, "position").value_or(""))});
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
    std::vector<std::uint32_t> roots_;  // open elements
    std::map<std::string, std::uint32_t> names_;
    std::string text_;
    std::uint32_t plants_ = 0;
    std::uint32_t line_ = 0;
};

}  // namespace

Document parse_document(std::string_view text, const std::string& source, const Context& ctx) {
    DocumentBuilder builder(text.size(), source, ctx);
    io_internal::parse_xml(text, "RSML", source, builder);
    return builder.take();
}

}  // namespace coppice::rsml
