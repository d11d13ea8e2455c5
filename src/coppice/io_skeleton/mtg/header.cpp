#include "coppice/io_skeleton/mtg/header_internal.h"

#include <algorithm>

#include <fmt/format.h>

#include "coppice/base/error.h"

namespace coppice::mtg {

namespace {

enum class Section { none, code, classes, description, features, mtg };

/// Returns whether a line such as "CLASSES :" begins a section.
Section compute_section(std::string_view line) {
    const std::string_view word = trimmed(line.substr(0, line.find_first_of(" \t:")));
    if (word == "CODE") return Section::code;
    if (word == "CLASSES") return Section::classes;
    if (word == "DESCRIPTION") return Section::description;
    if (word == "FEATURES") return Section::features;
    if (word == "MTG") return Section::mtg;
    return Section::none;
}

class HeaderReader {
  public:
    HeaderReader(LineReader& lines, const std::string& source) : lines_(lines), source_(source) {}

    Header read() {
        Section section = Section::none;
        while (lines_.next()) {
            const std::string line = without_comments(lines_.line());
            if (trimmed(line).empty()) continue;
            if (section == Section::mtg) {
                name_columns(line);
                return std::move(header_);
            }
            const Section begun = compute_section(line);
            if (begun == Section::code) header_.is_form_b = line.find("FORM-B") != line.npos;
            if (begun != Section::none) {
                section = begun;
            } else if (section == Section::classes) {
                add_class(line);
            } else if (section == Section::features) {
                add_feature(line);
            }
        }
        throw InvalidInput(
            fmt::format("{}: this is not an MTG file: it needs a section MTG with a first line, ENTITY-CODE "
                        "or TOPO, that names the columns",
                        source_));
    }

  private:
    void add_class(const std::string& line) {
        split_at_blanks(line, words_);
        if (words_.size() < 2 || words_[0] == "SYMBOL") return;
        const auto scale = parse_integer(words_[1]);
        if (!scale || *scale < 0 || *scale > kFinestScale) {
            fail_at(source_, lines_.number(),
                    fmt::format("the scale of class {} is {}; it must be a whole number from 0 to {}",
                                in_quotes(words_[0]), in_quotes(words_[1]), kFinestScale));
        }
        header_.scale[std::string(words_[0])] = static_cast<std::uint16_t>(*scale);
    }

    void add_feature(const std::string& line) {
        split_at_blanks(line, words_);
        if (words_.size() < 2) return;
        is_text_[std::string(words_[0])] = words_[1] != "INT" && words_[1] != "REAL";
    }

    void name_columns(const std::string& line) {
        header_.has_tabs = line.find('\t') != line.npos;
        if (header_.has_tabs) {
            split_at(line, '\t', words_);
        } else {
            split_at_blanks(line, words_);
        }
        header_.code_cells = static_cast<std::uint32_t>(words_.size());
        for (std::uint32_t i = 1; i < words_.size(); ++i) {
            if (words_[i].empty()) continue;
            if (header_.columns.empty()) header_.code_cells = i;
            const auto text = is_text_.find(words_[i]);
            header_.columns.push_back({std::string(words_[i]), text == is_text_.end() || !text->second});
            header_.cells.push_back(i);
        }
    }

    LineReader& lines_;
    const std::string& source_;
    Header header_;
    std::map<std::string, bool, std::less<>> is_text_;
    std::vector<std::string_view> words_;
};

}  // namespace

std::string without_comments(std::string_view line) {
    std::string kept;
    bool is_comment = false;
    for (const char c : line) {
        if (c == '#') is_comment = true;
        if (c == '\t') is_comment = false;
        if (!is_comment) kept += c;
    }
    return kept;
}

Header parse_header(LineReader& lines, const std::string& source) {
    return HeaderReader(lines, source).read();
}

}  // namespace coppice::mtg
