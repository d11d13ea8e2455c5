#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "coppice/base/ascii.h"
#include "coppice/base/error.h"
#include "coppice/base/quote.h"
#include "coppice/edit/selection.h"

namespace coppice {
namespace {

constexpr int kDeepest = 64;
constexpr std::size_t kMaxIds = 1'000'000;

/// Names of the conditions, in the order of SelectionKind.
constexpr std::array<std::string_view, 17> kNames{"all",    "roots", "tips",     "forks", "id",    "subtree",
                                                  "axis",   "path",  "children", "tree",  "order", "radius",
                                                  "height", "box",   "solid",    "near",  "at"};

constexpr auto kFirstWithIds = SelectionKind::id, kLastWithIds = SelectionKind::tree;
constexpr auto kFirstRange = SelectionKind::order, kLastRange = SelectionKind::height;

bool takes_nothing(SelectionKind kind) { return kind < kFirstWithIds; }
bool takes_ids(SelectionKind kind) { return kind >= kFirstWithIds && kind <= kLastWithIds; }
bool takes_range(SelectionKind kind) { return kind >= kFirstRange && kind <= kLastRange; }

/// Recursive descent: either = both { | both }, both = one { & one }, one = ! one | ( either ) | name(...).
class Parser {
  public:
    explicit Parser(std::string_view text) : text_(text) {}

    Selection run() {
        Selection all = either();
        skip();
        if (at_ < text_.size()) fail("& or |");
        return all;
    }

  private:
    Selection either() { return joined(SelectionKind::either, "|", "or"); }
    Selection both() { return joined(SelectionKind::both, "&", "and"); }

    Selection joined(SelectionKind kind, std::string_view sign, std::string_view word) {
        const auto part = [&] { return kind == SelectionKind::either ? both() : one(); };
        Selection left = part();
        while (take(sign) || take_word(word)) {
            Selection joint{.kind = kind, .ids = {}, .numbers = {}, .name = {}, .parts = {}};
            joint.parts.push_back(std::move(left));
            joint.parts.push_back(part());
            left = std::move(joint);
        }
        return left;
    }

    Selection one() {
        if (++depth_ > kDeepest)
            throw InvalidInput(
                fmt::format("a selection may be nested at most {} deep; use fewer parentheses", kDeepest));
        Selection out;
        if (take("!") || take_word("not")) {
            out.kind = SelectionKind::without;
            out.parts.push_back(one());
        } else if (take("(")) {
            out = either();
            if (!take(")")) fail("a closing parenthesis");
        } else {
            out = atom();
        }
        --depth_;
        return out;
    }

    Selection atom() {
        skip();
        if (at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9') {
            Selection out;
            out.kind = SelectionKind::id;
            add_ids(out.ids);
            return out;
        }
        const std::string_view name = word();
        std::size_t kind = 0;
        while (kind < kNames.size() && kNames[kind] != name) ++kind;
        if (kind == kNames.size())
            fail(
                "an id, or one of all, roots, tips, forks, id(), subtree(), axis(), path(), "
                "children(), tree(), order(), radius(), height(), box(), solid(), near(), at()");
        Selection out;
        out.kind = static_cast<SelectionKind>(kind);
        at_ += name.size();
        if (!takes_nothing(out.kind)) arguments(out);
        return out;
    }

    void arguments(Selection& out) {
        const std::string name(kNames[static_cast<std::size_t>(out.kind)]);
        if (!take("(")) fail("( after " + name);
        if (takes_ids(out.kind)) {
            named_nodes(out);
        } else if (out.kind == SelectionKind::at) {
            place(out);
        } else if (out.kind == SelectionKind::solid) {
            skip();
            out.name = word();
            at_ += out.name.size();
            if (out.name.empty()) fail("the name of a solid");
        } else if (takes_range(out.kind)) {
            range(out);
        } else {
            const int count = out.kind == SelectionKind::box ? 6 : 3;
            for (int i = 0; i < count; ++i) {
                if (i > 0 && !take(",")) fail(fmt::format("{} numbers separated by commas", count));
                out.numbers.push_back(number());
            }
        }
        if (!take(")")) fail("a closing parenthesis");
    }

    /// Parses ids, or a selection of the nodes.
    void named_nodes(Selection& out) {
        skip();
        const std::size_t begin = at_;
        if (out.kind == SelectionKind::id || is_digit(peek())) {
            do add_ids(out.ids);
            while (take(","));
            skip();
            if (out.kind == SelectionKind::id || peek() == ')') return;
        }
        at_ = begin;
        out.ids.clear();
        out.parts.push_back(either());
    }

    void place(Selection& out) {
        constexpr std::size_t kMin = 5, kMax = 9;
        do out.numbers.push_back(number());
        while (out.numbers.size() < kMax && take(","));
        const auto& n = out.numbers;
        const auto whole = [](double value) {
            return value >= 0 && value < 4294967295.0 && value == std::floor(value);
        };
        const bool good = n.size() >= kMin && n.size() != kMin + 1 && whole(n[3]) && n[4] > 0 &&
                          (n.size() < 7 || (n[5] >= 0 && n[5] <= 1 && n[6] >= 0)) &&
                          (n.size() < 8 || n[7] > 0) && (n.size() < kMax || whole(n[8]));
        if (!good)
            throw InvalidInput(
                "at() requires x,y,z,order,radius[,along,length[,within[,id]]]: metres, along from 0 to 1, "
                "and order and id whole numbers");
    }

    void range(Selection& out) {
        constexpr double kNone = std::numeric_limits<double>::infinity();
        skip();
        const double low = peek() == ',' ? -kNone : number();
        double high = out.kind == SelectionKind::order ? low : kNone;
        if (take(",")) {
            skip();
            high = peek() == ')' ? kNone : number();
        } else if (out.kind != SelectionKind::order) {
            fail("two numbers separated by a comma, one of which may be left out");
        }
        out.numbers = {low, high};
    }

    void add_ids(std::vector<StableId>& ids) {
        const std::uint32_t first = id();
        const std::uint32_t last = take("-") ? id() : first;
        if (last < first || last - first >= kMaxIds - std::min(kMaxIds, ids.size()))
            throw InvalidInput(
                fmt::format("{}-{} is not a range of ids: the smaller id comes first, and at most {} are "
                            "allowed; use subtree(ID) for many",
                            first, last, kMaxIds));
        for (std::uint32_t i = first; i < last; ++i) ids.emplace_back(i);
        ids.emplace_back(last);
    }

    std::uint32_t id() {
        skip();
        std::uint32_t value = 0;
        const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
        if (error != std::errc() || value == StableId().index()) fail("the id of a node");
        at_ = static_cast<std::size_t>(end - text_.data());
        return value;
    }

    double number() {
        skip();
        double value = 0;
        const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
        if (error != std::errc() || !std::isfinite(value)) fail("a number");
        at_ = static_cast<std::size_t>(end - text_.data());
        return value;
    }

    void skip() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
    }
    char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    std::string_view word() const {
        std::size_t end = at_;
        const auto is_of_word = [](char c) {
            return is_letter(c) || is_digit(c) || c == '_' || c == '-' || c == '.';
        };
        while (end < text_.size() && is_of_word(text_[end])) ++end;
        return text_.substr(at_, end - at_);
    }
    bool take(std::string_view sign) {
        skip();
        if (!text_.substr(at_).starts_with(sign)) return false;
        at_ += sign.size();
        return true;
    }
    bool take_word(std::string_view name) {
        skip();
        if (word() != name) return false;
        at_ += name.size();
        return true;
    }

    [[noreturn]] void fail(const std::string& wanted) const {
        const std::string_view rest = text_.substr(at_);
        throw InvalidInput(fmt::format("the selection {} needs {} at its {}", quote(text_), wanted,
                                       rest.empty() ? "end" : quote(rest)));
    }

    std::string_view text_;
    std::size_t at_ = 0;
    int depth_ = 0;
};

std::string number_text(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

std::string ids_text(const std::vector<StableId>& ids) {
    std::string out;
    for (std::size_t i = 0; i < ids.size();) {
        std::size_t end = i + 1;
        while (end < ids.size() && ids[end].index() == ids[end - 1].index() + 1) ++end;
        if (!out.empty()) out += ',';
        out += fmt::format("{}", ids[i].index());
        if (end > i + 1) out += fmt::format("-{}", ids[end - 1].index());
        i = end;
    }
    return out;
}

std::string part_text(const Selection& part) {
    const bool joint = part.kind == SelectionKind::both || part.kind == SelectionKind::either;
    return joint ? fmt::format("({})", to_text(part)) : to_text(part);
}

}  // namespace

Selection parse_selection(std::string_view text) { return Parser(text).run(); }

std::string to_text(const Selection& s) {
    if (s.kind == SelectionKind::without) return fmt::format("!{}", part_text(s.parts.at(0)));
    if (s.kind == SelectionKind::both || s.kind == SelectionKind::either) {
        return fmt::format("{}{}{}", part_text(s.parts.at(0)), s.kind == SelectionKind::both ? '&' : '|',
                           part_text(s.parts.at(1)));
    }
    const std::string_view name = kNames[static_cast<std::size_t>(s.kind)];
    if (takes_nothing(s.kind)) return std::string(name);
    const bool one_id = s.kind == SelectionKind::id && s.ids.size() == 1;
    if (!s.parts.empty()) return fmt::format("{}({})", name, to_text(s.parts[0]));
    if (takes_ids(s.kind)) return one_id ? ids_text(s.ids) : fmt::format("{}({})", name, ids_text(s.ids));
    if (s.kind == SelectionKind::solid) return fmt::format("{}({})", name, s.name);
    const bool one_order = s.kind == SelectionKind::order && s.numbers[0] == s.numbers[1];
    std::vector<std::string> numbers;
    for (const double n : s.numbers) numbers.push_back(number_text(n));
    if (one_order) numbers.resize(1);
    return fmt::format("{}({})", name, fmt::join(numbers, ","));
}

void for_each_id(Selection& selection, const std::function<void(StableId&)>& visit) {
    for (StableId& id : selection.ids) visit(id);
    for (Selection& part : selection.parts) for_each_id(part, visit);
}

}  // namespace coppice
