#include <algorithm>
#include <cstdint>
#include <vector>

#include "coppice/io_skeleton/axes_internal.h"
#include "coppice/io_skeleton/encoder_internal.h"
#include "coppice/io_skeleton/writers_internal.h"

namespace coppice {

namespace {

/// A node to be written, in the column of the order of its axis.
struct Row {
    NodeId node;
    std::uint32_t column = 0;
    bool begins_axis = false;
};

class MtgWriter {
  public:
    MtgWriter(const Skeleton& skeleton, std::string_view unit, std::span<const NodeAttribute> attributes,
              const Context& ctx)
        : skeleton_(skeleton), unit_(unit), attributes_(attributes), out_(skeleton, ctx) {
        constexpr std::uint32_t kMaxColumns = 32;
        for (const NodeId n : nodes(skeleton)) next_.push_back(skeleton.leader(n));
        list_rows();
        if (columns_ <= kMaxColumns) return;
        follow_most_nodes();
        list_rows();
    }

    std::string text() {
        bool is_numbered = false;
        for (std::uint32_t i = 0; i < rows_.size(); ++i)
            is_numbered = is_numbered || rows_[i].node.index() != i;
        add_head(is_numbered);
        std::uint32_t plants = 0, axes = 0;
        for (const Row& row : rows_) {
            const bool is_root = skeleton_.is_root(row.node);
            if (is_root) out_.add(FMT_COMPILE("/P{}\n"), ++plants);
            add_tabs(row.column);
            const std::uint32_t label = row.node.index() + 1;
            if (row.begins_axis) {
                out_.add(FMT_COMPILE("{}A{}/N{}"), is_root ? "^/" : "+", ++axes, label);
            } else {
                out_.add(FMT_COMPILE("^<N{}"), label);
            }
            add_tabs(columns_ - row.column);
            out_.add_position(row.node, '\t');
            out_.add(FMT_COMPILE("\t{}"), skeleton_.radius(row.node));
            for (const NodeAttribute& a : attributes_)
                out_.add(FMT_COMPILE("\t{}"), a.values[row.node.index()]);
            if (is_numbered) out_.add(FMT_COMPILE("\t{}"), row.node.index());
            out_.add(FMT_COMPILE("\n"));
        }
        return out_.text();
    }

  private:
    /// Lists the rows in depth-first order: a node, its laterals with their descendants, then the rest of its
    /// axis.
    void list_rows() {
        rows_.clear();
        columns_ = 1;
        std::vector<Row> open;
        for (std::uint32_t i = skeleton_.size(); i-- > 0;) {
            if (skeleton_.is_root(NodeId(i))) open.push_back({NodeId(i), 0, true});
        }
        while (!open.empty()) {
            const Row row = open.back();
            open.pop_back();
            rows_.push_back(row);
            columns_ = std::max(columns_, row.column + 1);
            const NodeId next = next_[row.node.index()];
            if (next) open.push_back({next, row.column, false});
            const auto children = skeleton_.children(row.node);
            for (std::size_t i = children.size(); i-- > 0;) {
                if (children[i] != next) open.push_back({children[i], row.column + 1, true});
            }
        }
    }

    /// If axes are nested too deeply for a table, lets each axis follow the child with the largest subtree:
    /// then the number of columns before a node is at most the logarithm of the number of nodes.
    void follow_most_nodes() {
        std::vector<std::uint32_t> hanging(skeleton_.size(), 1);
        for (std::uint32_t i = skeleton_.size(); i-- > 0;) {
            const NodeId n(i);
            if (!skeleton_.is_root(n)) hanging[skeleton_.parent(n).index()] += hanging[i];
            for (const NodeId child : skeleton_.children(n)) {
                if (hanging[child.index()] > hanging[next_[i].index()]) next_[i] = child;
            }
        }
    }

    void add_head(bool is_numbered) {
        out_.add(
            FMT_COMPILE(
                "{}; units: {}\nCODE:\tFORM-A\n\n"
                "CLASSES:\nSYMBOL\tSCALE\tDECOMPOSITION\tINDEXATION\tDEFINITION\n$\t0\tFREE\tFREE\tIMPLICIT\n"
                "P\t1\tFREE\tFREE\tEXPLICIT\nA\t2\tFREE\tFREE\tEXPLICIT\nN\t3\tFREE\tFREE\tEXPLICIT\n\n"
                "DESCRIPTION:\nLEFT\tRIGHT\tRELTYPE\tMAX\nA\tA\t+\t?\nN\tN\t<\t?\nN\tN\t+\t?\n\n"
                "FEATURES:\nNAME\tTYPE\nXX\tREAL\nYY\tREAL\nZZ\tREAL\nradius\tREAL\n"),
            kMtgMark, unit_);
        for (const NodeAttribute& a : attributes_) out_.add(FMT_COMPILE("{}\tREAL\n"), a.name);
        if (is_numbered) out_.add(FMT_COMPILE("{}\tINT\n"), kNodeNumber);
        out_.add(FMT_COMPILE("\nMTG:\nENTITY-CODE"));
        add_tabs(columns_);
        out_.add(FMT_COMPILE("XX\tYY\tZZ\tradius"));
        for (const NodeAttribute& a : attributes_) out_.add(FMT_COMPILE("\t{}"), a.name);
        if (is_numbered) out_.add(FMT_COMPILE("\t{}"), kNodeNumber);
        out_.add(FMT_COMPILE("\n"));
    }

    void add_tabs(std::uint32_t count) {
        for (std::uint32_t i = 0; i < count; ++i) out_.add(FMT_COMPILE("\t"));
    }

    const Skeleton& skeleton_;
    std::string_view unit_;
    std::span<const NodeAttribute> attributes_;
    std::vector<NodeId> next_;  // child that continues the axis, by node
    std::vector<Row> rows_;
    std::uint32_t columns_ = 1;  // number of columns of the code
    Encoder out_;
};

}  // namespace

std::string encode_mtg(const Skeleton& skeleton, std::string_view unit,
                       std::span<const NodeAttribute> attributes, const Context& ctx) {
    return MtgWriter(skeleton, unit, attributes, ctx).text();
}

}  // namespace coppice
