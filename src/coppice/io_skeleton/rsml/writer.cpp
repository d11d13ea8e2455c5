#include <algorithm>
#include <cstdint>
#include <vector>

#include "coppice/io_skeleton/axes_internal.h"
#include "coppice/io_skeleton/encoder_internal.h"
#include "coppice/io_skeleton/writers_internal.h"

namespace coppice {

namespace {

class RsmlWriter {
  public:
    RsmlWriter(const Skeleton& skeleton, std::string_view unit, std::span<const NodeAttribute> attributes,
               const Context& ctx)
        : skeleton_(skeleton),
          unit_(unit),
          attributes_(attributes),
          axes_(find_axes(skeleton)),
          is_numbered_(!is_in_order_of_axes(skeleton, axes_)),
          out_(skeleton, ctx) {}

    std::string text() {
        add_head();
        for (std::size_t i = 0; i < axes_.size(); ++i) {
            const std::uint32_t next = i + 1 < axes_.size() ? axes_[i + 1].order : 0;
            if (axes_[i].order == 0)
                out_.add(FMT_COMPILE("    <plant id=\"{}\" label=\"tree\">\n"), ++plants_);
            add_axis(i);
            for (std::uint32_t order = axes_[i].order + 1; order > next; --order) {
                out_.add(FMT_COMPILE("{}</root>\n"), indent(order - 1));
            }
            if (next == 0) out_.add(FMT_COMPILE("    </plant>\n"));
        }
        out_.add(FMT_COMPILE("  </scene>\n</rsml>\n"));
        return out_.text();
    }

  private:
    /// Returns the indentation of a root of this order; it is limited, so that deep files do not consist of
    /// blanks.
    static std::string_view indent(std::uint32_t order) {
        constexpr std::string_view kBlanks = "                        ";
        return kBlanks.substr(0, std::min<std::size_t>(kBlanks.size(), 6 + 2 * std::size_t{order}));
    }

    void add_head() {
        out_.add(FMT_COMPILE("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                             "<rsml xmlns:po=\"http://www.plantontology.org/xml-dtd/po.dtd\">\n"
                             "  <metadata>\n    <version>1</version>\n    <unit>{}</unit>\n    "
                             "<resolution>1</resolution>\n"
                             "    <software>Coppice</software>\n    <property-definitions>\n"),
                 unit_);
        add_definition("parent-node", "integer");
        add_definition("diameter", "real");
        for (const NodeAttribute& a : attributes_) add_definition(a.name, "real");
        if (is_numbered_) add_definition(kNodeNumber, "integer");
        out_.add(FMT_COMPILE("    </property-definitions>\n  </metadata>\n  <scene>\n"));
    }

    void add_definition(std::string_view label, std::string_view type) {
        out_.add(FMT_COMPILE(
                     "      <property-definition><label>{}</label><type>{}</type></property-definition>\n"),
                 label, type);
    }

    void add_axis(std::size_t index) {
        const SkeletonAxis& axis = axes_[index];
        const std::string_view in = indent(axis.order);
        line_.clear();
        if (axis.order > 0) line_.push_back(skeleton_.parent(axis.first));
        for (NodeId n = axis.first; n; n = skeleton_.leader(n)) line_.push_back(n);
        out_.add(FMT_COMPILE("{}<root id=\"{}\" label=\"axis\">\n"), in, index + 1);
        if (axis.order > 0) {
            // The polyline of a parent that is itself a lateral begins with a node of its own parent.
            const std::uint32_t place = axis.place + (axis.order > 1 ? 1 : 0);
            out_.add(FMT_COMPILE("{}  <properties><parent-node value=\"{}\"/></properties>\n"), in, place);
        }
        out_.add(FMT_COMPILE("{}  <geometry>\n{}    <polyline>\n"), in, in);
        for (const NodeId n : line_) add_point(n);
        out_.add(FMT_COMPILE("{}    </polyline>\n{}  </geometry>\n{}  <functions>\n"), in, in, in);
        // A lateral begins with its own radius rather than that of its parent.
        add_function("diameter",
                     [&](NodeId n) { return 2 * skeleton_.radius(n == line_.front() ? axis.first : n); });
        for (const NodeAttribute& a : attributes_) {
            add_function(a.name, [&](NodeId n) { return a.values[n.index()]; });
        }
        if (is_numbered_) add_function(kNodeNumber, [](NodeId n) { return n.index(); });
        out_.add(FMT_COMPILE("{}  </functions>\n"), in);
    }

    void add_point(NodeId n) {
        out_.add(FMT_COMPILE("<point x=\""));
        out_.add_coordinate(n, 0);
        out_.add(FMT_COMPILE("\" y=\""));
        out_.add_coordinate(n, 1);
        out_.add(FMT_COMPILE("\" z=\""));
        out_.add_coordinate(n, 2);
        out_.add(FMT_COMPILE("\"/>\n"));
    }

    template <class Value>
    void add_function(std::string_view name, const Value& value) {
        out_.add(FMT_COMPILE("<function name=\"{}\" domain=\"polyline\">\n"), name);
        for (const NodeId n : line_) out_.add(FMT_COMPILE("<sample>{}</sample>\n"), value(n));
        out_.add(FMT_COMPILE("</function>\n"));
    }

    const Skeleton& skeleton_;
    std::string_view unit_;
    std::span<const NodeAttribute> attributes_;
    std::vector<SkeletonAxis> axes_;
    bool is_numbered_;
    Encoder out_;
    std::vector<NodeId> line_;
    std::uint32_t plants_ = 0;
};

}  // namespace

std::string encode_rsml(const Skeleton& skeleton, std::string_view unit,
                        std::span<const NodeAttribute> attributes, const Context& ctx) {
    return RsmlWriter(skeleton, unit, attributes, ctx).text();
}

}  // namespace coppice
