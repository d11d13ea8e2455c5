#include "coppice/io_skeleton/format.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "coppice/base/ascii.h"
#include "coppice/io/ply_header.h"
#include "coppice/io/text.h"
#include "coppice/io_skeleton/cylinders/columns_internal.h"
#include "coppice/io_skeleton/parsers_internal.h"

namespace coppice {

namespace {

/// Returns whether the first element of an XML file is rsml; comments may precede it.
bool is_rsml(std::string_view content) {
    if (content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);
    const std::size_t first = content.find_first_not_of(" \t\r\n");
    if (first == content.npos || content[first] != '<') return false;
    std::size_t at = first;
    while (at != content.npos && at + 1 < content.size() &&
           (content[at + 1] == '?' || content[at + 1] == '!')) {
        const bool comment = content.substr(at).starts_with("<!--");
        at = content.find(comment ? "-->" : ">", at + 1);
        at = content.find('<', at);
    }
    if (at == content.npos) return false;
    const std::string name =
        to_lower(content.substr(at + 1, content.find_first_of(" \t\r\n>/", at) - at - 1));
    return name == "rsml" || name.ends_with(":rsml");
}

/// Returns the numbers of a row; empty if it contains anything else.
std::vector<double> parse_numbers(std::string_view line, bool commas) {
    std::vector<std::string_view> words;
    split_at_blanks(line, words, commas);
    std::vector<double> numbers;
    for (const std::string_view word : words) {
        const auto number = parse_number(word);
        if (!number) return {};
        numbers.push_back(*number);
    }
    return numbers;
}

/// Distinguishes rows of seven numbers that are nodes of SWC from other rows, such as points with colours:
/// SWC rows begin with distinct integers, and at least half of them end with one of these or -1.
class SwcRows {
  public:
    bool add(const std::vector<double>& row) {
        constexpr double kTypes = 1e4;
        if (row.size() != kColumns || !whole(row[0]) || !whole(row[1]) || !whole(row[6])) return false;
        if (row[0] < 0 || row[1] < 0 || row[1] > kTypes || row[0] == row[6]) return false;
        parents_.push_back(row[6]);
        return ids_.insert(row[0]).second;
    }
    bool are_linked() const {
        const auto known = std::ranges::count_if(
            parents_, [&](double parent) { return parent == -1 || ids_.contains(parent); });
        return 2 * known >= static_cast<std::ptrdiff_t>(parents_.size());
    }
    static constexpr std::size_t kColumns = 7;

  private:
    static bool whole(double number) { return std::trunc(number) == number; }
    std::set<double> ids_;
    std::vector<double> parents_;
};

/// Checks the first rows of a text that are not comments; the first of them has seven numbers.
bool are_swc_rows(std::string_view content) {
    constexpr std::size_t kRows = 100;
    SwcRows rows;
    LineReader lines(content);
    for (std::size_t count = 0; count < kRows && lines.next();) {
        const std::string_view line = trimmed(lines.line().substr(0, lines.line().find('#')));
        if (line.empty()) continue;
        const std::vector<double> row = parse_numbers(line, false);
        // The content may be cut within a row; the parser reports invalid rows.
        if (count > 0 && row.size() != SwcRows::kColumns) break;
        if (!rows.add(row)) return false;
        ++count;
    }
    return rows.are_linked();
}

/// Returns whether a table of cylinders follows lines of other content, such as titles or another table, the
/// first of which begins with a word.
bool holds_cylinders(std::string_view content) {
    constexpr std::uint32_t kLines = 5000;
    LineReader lines(content);
    while (lines.number() < kLines && lines.next())
        if (begins_cylinders(lines.line())) return true;
    return false;
}

/// Returns the format of a text by its first line that is neither empty nor a comment, and by the following
/// lines if it is ambiguous.
std::optional<SkeletonFormat> format_of_lines(std::string_view line, std::string_view content) {
    std::vector<std::string_view> words;
    split_at_blanks(line, words);
    const std::string_view first = words[0];
    if (first == "v" || first == "l" || first == "o" || first == "g" || first == "mtllib")
        return SkeletonFormat::obj;
    if (first == "n" && words.size() >= 4) return SkeletonFormat::gel;
    if (parse_numbers(line.substr(0, line.find('#')), false).size() == SwcRows::kColumns) {
        if (are_swc_rows(content)) return SkeletonFormat::swc;
        return std::nullopt;
    }
    if (first.starts_with("CODE") && line.find("FORM-") != line.npos) return SkeletonFormat::mtg;
    if (is_raycloud_header(line)) return SkeletonFormat::raycloud;
    if (is_cylinder_header(line) || is_treeqsm_row(parse_numbers(line, true)))
        return SkeletonFormat::cylinders;
    if (!parse_number(first) && holds_cylinders(content)) return SkeletonFormat::cylinders;
    return std::nullopt;
}

}  // namespace

std::optional<SkeletonFormat> format_of_extension(const std::filesystem::path& path) {
    struct Entry {
        std::string_view extension;
        SkeletonFormat format;
    };
    constexpr std::array<Entry, 10> kEntries{{{"swc", SkeletonFormat::swc},
                                              {"csv", SkeletonFormat::cylinders},
                                              {"mat", SkeletonFormat::mat},
                                              {"ply", SkeletonFormat::ply},
                                              {"graph", SkeletonFormat::gel},
                                              {"gel", SkeletonFormat::gel},
                                              {"obj", SkeletonFormat::obj},
                                              {"json", SkeletonFormat::json},
                                              {"rsml", SkeletonFormat::rsml},
                                              {"mtg", SkeletonFormat::mtg}}};
    const std::string extension = plain_name(path.extension().string());
    for (const Entry& entry : kEntries) {
        if (entry.extension == extension) return entry.format;
    }
    return std::nullopt;
}

std::optional<SkeletonFormat> format_of_content(std::string_view content) {
    if (is_ply(content)) return SkeletonFormat::ply;
    if (content.starts_with("MATLAB ")) return SkeletonFormat::mat;
    if (is_rsml(content)) return SkeletonFormat::rsml;
    LineReader lines(content);
    while (lines.next()) {
        const std::string_view line = trimmed(lines.line());
        if (line.empty() || line[0] == '#') continue;
        if (line[0] == '{') return SkeletonFormat::json;
        return format_of_lines(line, content);
    }
    return std::nullopt;
}

}  // namespace coppice
