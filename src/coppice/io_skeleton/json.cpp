#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "coppice/base/error.h"
#include "coppice/io/text.h"
#include "coppice/io_skeleton/node_attribute.h"
#include "coppice/io_skeleton/parsers_internal.h"
#include "coppice/system/file_progress.h"

namespace coppice {

namespace {

constexpr std::size_t kDeepest = 32;

/// Collects the columns of a skeleton from the events of a JSON parser, so that nothing else of the file is
/// stored.
class Columns {
  public:
    using number_integer_t = nlohmann::json::number_integer_t;
    using number_unsigned_t = nlohmann::json::number_unsigned_t;
    using number_float_t = nlohmann::json::number_float_t;
    using string_t = nlohmann::json::string_t;
    using binary_t = nlohmann::json::binary_t;

    Columns(std::string_view text, const std::string& source, const Context& ctx)
        : text_(text), source_(source), progress_({.stop = ctx.stop}, 0) {}

    bool null() {
        if (column_ == Column::radius && depth_ == 2) radius_.push_back(kUnknown);
        return no_number();
    }
    bool boolean(bool) { return no_number(); }
    bool number_integer(number_integer_t value) { return number(static_cast<double>(value)); }
    bool number_unsigned(number_unsigned_t value) { return number(static_cast<double>(value)); }
    bool number_float(number_float_t value, const string_t&) { return number(value); }
    bool string(const string_t& value) {
        if (column_ == Column::format && depth_ == 1) is_skeleton_ = value == "coppice-skeleton";
        return no_number();
    }
    bool binary(binary_t&) { return true; }
    bool start_object(std::size_t) {
        pass_over_nested();
        return enter();
    }
    bool end_object() { return leave(); }
    bool start_array(std::size_t) {
        if (depth_ > 1) pass_over_nested();
        enter();
        if (depth_ == 3 && column_ == Column::position) point_begin_ = position_.size();
        return true;
    }
    bool end_array() {
        if (depth_ == 3 && column_ == Column::position && position_.size() != point_begin_ + 3) {
            fail(fmt::format("position {} must have three numbers", point_begin_ / 3));
        }
        return leave();
    }
    bool key(const string_t& name) {
        if (depth_ != 1) return true;
        column_ = name == "format"      ? Column::format
                  : name == "version"   ? Column::version
                  : name == "origin"    ? Column::origin
                  : name == "parent"    ? Column::parent
                  : name == "position"  ? Column::position
                  : name == "radius"    ? Column::radius
                  : name == "stable_id" ? Column::id
                                        : Column::other;
        if (column_ == Column::other && is_attribute_name(name)) {
            column_ = Column::attribute;
            attributes_.push_back({name, {}});
        }
        return true;
    }
    bool parse_error(std::size_t position, const std::string& token, const nlohmann::json::exception&) {
        const std::string_view before = text_.substr(0, std::min(position, text_.size()));
        fail_at(source_, static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')) + 1,
                fmt::format("this is not valid JSON near {}", in_quotes(token)));
    }

    RawSkeleton result() {
        std::erase_if(attributes_, [&](const RawAttribute& a) { return a.values.size() != parent_.size(); });
        return {nodes(), std::move(attributes_)};
    }

  private:
    enum class Column { other, format, version, origin, parent, position, radius, id, attribute };
    static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

    std::vector<RawNode> nodes() const {
        if (!is_skeleton_) fail("this JSON is not a skeleton: it needs \"format\": \"coppice-skeleton\"");
        if (version_ > 1) {
            throw Unsupported(fmt::format("{}: version {} of coppice-skeleton is newer than this program",
                                          source_, version_));
        }
        const std::size_t count = parent_.size();
        if (position_.size() != 3 * count || radius_.size() != count) {
            fail(fmt::format("the columns differ in length: {} parents, {} positions, {} radii", count,
                             position_.size() / 3, radius_.size()));
        }
        if (!id_.empty() && id_.size() != count)
            fail(
                fmt::format("there are {} ids for {} nodes; omit the ids or specify all", id_.size(), count));
        if (!origin_.empty() && origin_.size() != 3) fail("the origin must have three numbers");
        const Vec3d origin = origin_.empty() ? Vec3d{} : Vec3d{origin_[0], origin_[1], origin_[2]};
        std::vector<RawNode> nodes;
        nodes.reserve(count);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3d p{position_[3 * i], position_[3 * i + 1], position_[3 * i + 2]};
            nodes.push_back({static_cast<std::int64_t>(i), parent_[i], origin + p, radius_[i],
                             static_cast<std::uint32_t>(i + 1), id_.empty() ? StableId() : id_[i]});
        }
        return nodes;
    }

    bool no_number() {
        if (column_ == Column::attribute && depth_ == 2) attributes_.back().values.push_back(kUnknown);
        return true;
    }

    /// Only a plain array of numbers is an attribute.
    void pass_over_nested() {
        if (column_ != Column::attribute) return;
        attributes_.pop_back();
        column_ = Column::other;
    }

    bool number(double value) {
        progress_.at(++numbers_);
        if (column_ == Column::version && depth_ == 1) version_ = value;
        if (column_ == Column::origin && depth_ == 2) origin_.push_back(value);
        if (column_ == Column::position && depth_ == 3) position_.push_back(value);
        if (column_ == Column::radius && depth_ == 2) radius_.push_back(value);
        if (column_ == Column::attribute && depth_ == 2) attributes_.back().values.push_back(value);
        if (column_ == Column::parent && depth_ == 2) {
            const bool whole = value >= -1 && value < 4294967296.0 &&
                               value == static_cast<double>(static_cast<std::int64_t>(value));
            if (!whole)
                fail(fmt::format("the parent of node {} is {}; it must be an index, or -1 for none",
                                 parent_.size(), value));
            parent_.push_back(static_cast<std::int64_t>(value));
        }
        if (column_ == Column::id && depth_ == 2) id_.push_back(checked_id(value));
        return true;
    }

    StableId checked_id(double value) const {
        if (value >= 0 && value < 4294967295.0 && value == std::floor(value))
            return StableId(static_cast<std::uint32_t>(value));
        fail(fmt::format("the id of node {} is {}; it must be a whole number from 0 to 4294967294",
                         id_.size(), value));
    }

    bool enter() {
        if (++depth_ > kDeepest) fail("the JSON is nested too deeply");
        return true;
    }
    bool leave() {
        --depth_;
        return true;
    }
    [[noreturn]] void fail(const std::string& text) const {
        throw InvalidInput(fmt::format("{}: {}", source_, text));
    }

    std::string_view text_;
    const std::string& source_;
    FileProgress progress_;
    std::uint64_t numbers_ = 0;
    std::size_t depth_ = 0;
    Column column_ = Column::other;
    bool is_skeleton_ = false;
    double version_ = 1;
    std::vector<double> origin_, position_, radius_;
    std::vector<std::int64_t> parent_;
    std::vector<StableId> id_;
    std::vector<RawAttribute> attributes_;
    std::size_t point_begin_ = 0;
};

}  // namespace

RawSkeleton parse_skeleton_json(std::string_view text, const std::string& source, const Context& ctx) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    Columns columns(text, source, ctx);
    nlohmann::json::sax_parse(text.begin(), text.end(), &columns);
    return columns.result();
}

}  // namespace coppice
