#include "coppice/io_skeleton/mtg/document_internal.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <span>
#include <tuple>

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/io_skeleton/mtg/header_internal.h"

namespace coppice::mtg {

namespace {

/// State of the code: the next component belongs to `current`, and a successor or branch is attached to
/// `finest`, which differs if an entity of a coarser scale was begun and has no components yet.
struct Position {
    std::uint32_t current = 0;
    std::uint32_t finest = 0;
};

/// An operator and a label of a code: "<<E35".
struct Step {
    char edge = '/';
    bool is_range = false;   // E1<<E9
    bool is_shared = false;  // E1<.<E9: all have the features of the row
    std::uint16_t symbol = 0;
    std::uint16_t scale = 0;
    std::uint32_t index = kNoIndex;
};

std::string plain_number(std::string_view cell) {
    std::string text(cell);
    // Cells are separated by tabs, so that a comma can only be a decimal comma.
    if (std::ranges::count(text, ',') == 1 && text.find('.') == text.npos)
        std::ranges::replace(text, ',', '.');
    return text;
}

class CodeReader {
  public:
    CodeReader(std::string_view text, const std::string& source, const Context& ctx)
        : source_(source),
          lines_(text, ctx),
          header_(parse_header(lines_, source)),
          budget_(text.size() + 10'000) {
        document_.columns = header_.columns;
        document_.is_form_b = header_.is_form_b;
        document_.vertices.emplace_back();
        for (const auto& [symbol, scale] : header_.scale) document_.symbols.push_back(symbol);
    }

    Document read() {
        while (lines_.next()) {
            const std::string line = without_comments(lines_.line());
            if (trimmed(line).empty()) continue;
            if (header_.has_tabs) {
                split_at(line, '\t', cells_);
            } else {
                cut_at_blanks(line);
            }
            read_row();
        }
        sort_values();
        return std::move(document_);
    }

  private:
    /// Splits a row of a file without tabs: the indentation of the code determines its column.
    void cut_at_blanks(std::string_view line) {
        const auto indent = static_cast<std::uint32_t>(line.find_first_not_of(" \r\f\v"));
        while (!indents_.empty() && indents_.back() > indent) indents_.pop_back();
        if (indents_.empty() || indents_.back() < indent) indents_.push_back(indent);
        split_at_blanks(line, cells_);
        column_ = static_cast<std::uint32_t>(indents_.size() - 1);
    }

    void read_row() {
        changed_.clear();
        if (!header_.has_tabs) {
            read_code(cells_[0], column_);
        } else {
            const auto cells = std::min<std::size_t>(header_.code_cells, cells_.size());
            for (std::uint32_t i = 0; i < cells; ++i) {
                if (!cells_[i].empty()) read_code(cells_[i], i);
            }
        }
        if (!changed_.empty()) read_features();
    }

    void read_code(std::string_view code, std::uint32_t column) {
        bool caret = false, reuse = false;
        Position at;
        if (code == "*") {  // the entity of this column at another date
            if (const Position* known = find_position(column + 1)) changed_.assign(1, known->current);
            return;
        }
        if (code.front() == '^') {
            caret = true;
            code.remove_prefix(1);
            if (const Position* known = find_position(column + 1)) at = *known;
        } else if (code.front() == '(') {
            at = alias(code);
            reuse = true;
        } else if (const Position* known = find_position(column)) {
            at = *known;
        }
        bool is_first = true;
        while (!trimmed(code).empty()) {
            const Step step = next_step(code);
            if (is_first && at.current == 0) reuse = true;  // the full name of an entity
            const auto known = reuse && step.index != kNoIndex ? find_child(at, step, caret) : std::nullopt;
            reuse = known.has_value();
            changed_.clear();
            at = known ? *known : take(at, step, caret && is_first);
            if (changed_.empty()) changed_.push_back(at.current);
            is_first = false;
        }
        positions_.resize(column);
        positions_.push_back(at);
        is_set_.resize(column, false);
        is_set_.push_back(true);
    }

    /// Returns the last position in the columns before `column`; null for the whole scene.
    const Position* find_position(std::uint32_t column) const {
        for (std::size_t i = std::min<std::size_t>(column, positions_.size()); i-- > 0;) {
            if (is_set_[i]) return &positions_[i];
        }
        return nullptr;
    }

    Position alias(std::string_view& code) {
        const std::size_t end = code.find(')');
        if (end == code.npos) fail(fmt::format("{} lacks its ')'", in_quotes(code)));
        const auto name = trimmed(code.substr(1, end - 1));
        const auto known = aliases_.find(name);
        if (known == aliases_.end()) fail(fmt::format("no entity has the alias {}", in_quotes(name)));
        code.remove_prefix(end + 1);
        return known->second;
    }

    Step next_step(std::string_view& code) {
        const std::string_view whole = code;
        code = trimmed(code);
        Step step;
        for (const auto& [text, edge, range, shared] : {std::tuple{"<.<", '<', true, true},
                                                        {"+.+", '+', true, true},
                                                        {"<<", '<', true, false},
                                                        {"++", '+', true, false},
                                                        {"<", '<', false, false},
                                                        {"+", '+', false, false},
                                                        {"/", '/', false, false}}) {
            if (!code.starts_with(text)) continue;
            step.edge = edge;
            step.is_range = range;
            step.is_shared = shared;
            code.remove_prefix(std::string_view(text).size());
            const std::size_t end = code.find_first_of("/<+^ ");
            read_label(trimmed(code.substr(0, end)), step);
            code.remove_prefix(end == code.npos ? code.size() : end);
            return step;
        }
        fail(fmt::format("{} does not begin with one of / < + ^", in_quotes(whole)));
    }

    void read_label(std::string_view label, Step& step) const {
        const std::size_t letters = std::min(label.find_first_of("0123456789"), label.size());
        auto known = header_.scale.find(label.substr(0, letters));
        // The class symbol may be followed by letters.
        for (std::size_t n = letters; known == header_.scale.end() && n > 1;) {
            known = header_.scale.find(label.substr(0, --n));
        }
        if (known == header_.scale.end()) {
            fail(fmt::format("the class of {} is not among the CLASSES", in_quotes(label)));
        }
        if (known->second == 0)
            fail(fmt::format("{} is of scale 0, which is the whole scene", in_quotes(label)));
        step.scale = known->second;
        step.symbol = static_cast<std::uint16_t>(std::distance(header_.scale.begin(), known));
        const std::size_t end = label.find_first_not_of("0123456789", letters);
        const auto index = parse_integer(label.substr(letters, end == label.npos ? end : end - letters));
        if (index && *index < kNoIndex) step.index = static_cast<std::uint32_t>(*index);
    }

    Position take(Position at, Step step, bool caret) {
        if (!step.is_range) return add(at, step, caret);
        const Vertex& last = document_.vertices[at.current];
        const bool runs = last.symbol == step.symbol && last.index != kNoIndex && step.index != kNoIndex;
        const std::uint32_t end = step.index;
        for (step.index = runs ? last.index + 1 : end; runs && step.index < end; ++step.index) {
            if (budget_ == 0) {
                fail("ranges imply more entities than a file of this size can contain; check their numbers");
            }
            --budget_;
            at = add(at, step, caret);
            if (step.is_shared) changed_.push_back(at.current);
            caret = false;
        }
        step.index = end;
        at = add(at, step, caret);
        changed_.push_back(at.current);
        return at;
    }

    /// Returns the entity at which a step from a position begins: for steps in the same column ("^"), an
    /// entity without components is replaced by the finest one before it, unless the step continues it at its
    /// own scale.
    std::uint32_t find_start(Position at, const Step& step, bool caret) const {
        const Vertex& current = document_.vertices[at.current];
        const bool is_bare = current.components == 0 && at.current != 0;
        const bool follows = step.edge == '<' && current.scale == step.scale;
        return is_bare && (!caret || follows) ? at.current : at.finest;
    }

    Position add(Position at, const Step& step, bool caret) {
        auto& vertices = document_.vertices;
        const auto id = static_cast<std::uint32_t>(vertices.size());
        Vertex vertex;
        vertex.line = lines_.number();
        vertex.scale = step.scale;
        vertex.symbol = step.symbol;
        vertex.index = step.index;
        vertex.edge = step.edge;
        if (step.edge == '/') {
            const bool up = vertices[at.current].scale >= step.scale;
            vertex.complex = vertex.before = up ? coarser(at.current, step.scale) : at.current;
            const bool is_finest = up || at.current == at.finest || step.scale >= vertices[at.finest].scale;
            at = {id, is_finest ? id : at.finest};
        } else {
            vertex.before = find_start(at, step, caret);
            if (vertex.before == 0)
                fail("the first entity must be a component of the scene: begin it with /");
            vertex.complex = coarser(vertex.before, step.scale);
            at = {id, step.scale >= vertices[vertex.before].scale ? id : vertex.before};
        }
        ++vertices[vertex.complex].components;
        vertices.push_back(vertex);
        if (!step.is_range) {
            const std::uint32_t start = step.edge == '/' ? vertex.complex : vertex.before;
            children_[{start, step.edge, step.symbol, step.index}] = at;
        }
        return at;
    }

    /// Returns the closest of this entity and its complexes that has a coarser scale than `scale`.
    std::uint32_t coarser(std::uint32_t vertex, std::uint16_t scale) const {
        while (document_.vertices[vertex].scale >= scale) vertex = document_.vertices[vertex].complex;
        return vertex;
    }

    std::optional<Position> find_child(Position at, const Step& step, bool caret) const {
        const std::uint32_t start =
            step.edge == '/' ? coarser(at.current, step.scale) : find_start(at, step, caret);
        const auto known = children_.find({start, step.edge, step.symbol, step.index});
        if (known == children_.end()) return std::nullopt;
        return known->second;
    }

    void read_features() {
        for (std::uint32_t column = 0; column < header_.columns.size(); ++column) {
            const std::uint32_t cell = header_.cells[column];
            if (cell >= cells_.size() || cells_[cell].empty()) continue;
            if (!header_.columns[column].is_number) {
                if (header_.columns[column].name == "Alias") {
                    aliases_[std::string(cells_[cell])] = positions_.back();
                }
                continue;
            }
            const auto value = parse_number(plain_number(cells_[cell]));
            if (!value) continue;
            if (changed_.size() > budget_)
                fail("ranges share more values than a file of this size can contain");
            budget_ -= changed_.size() - 1;
            for (const std::uint32_t vertex : changed_) document_.values.push_back({vertex, column, *value});
        }
    }

    void sort_values() {
        auto& values = document_.values;
        const auto key = [](const Value& v) { return std::pair(v.vertex, v.column); };
        std::stable_sort(values.begin(), values.end(),
                         [&](const Value& a, const Value& b) { return key(a) < key(b); });
        // The last of several values of a cell is used.
        std::reverse(values.begin(), values.end());
        values.erase(std::unique(values.begin(), values.end(),
                                 [&](const Value& a, const Value& b) { return key(a) == key(b); }),
                     values.end());
        std::reverse(values.begin(), values.end());
    }

    [[noreturn]] void fail(const std::string& text) const { fail_at(source_, lines_.number(), text); }

    const std::string& source_;
    LineReader lines_;
    Header header_;
    Document document_;
    std::vector<std::string_view> cells_;
    std::vector<std::uint32_t> indents_;  // of rows without tabs
    std::uint32_t column_ = 0;
    std::vector<Position> positions_;  // by column
    std::vector<bool> is_set_;
    std::vector<std::uint32_t> changed_;  // entities to which the features of the current row belong
    std::map<std::string, Position, std::less<>> aliases_;
    std::map<std::tuple<std::uint32_t, char, std::uint16_t, std::uint32_t>, Position> children_;
    std::size_t budget_;  // remaining number of entities that ranges may imply
};

}  // namespace

Document parse_document(std::string_view text, const std::string& source, const Context& ctx) {
    return CodeReader(text, source, ctx).read();
}

}  // namespace coppice::mtg
