#include "coppice/scene/script/statements.h"

#include <fmt/format.h>

#include <algorithm>

#include "coppice/scene/script/script.h"

namespace coppice {
namespace {

/// Reads a line at the beginning of the text; returns whether it continues on the next line.
bool take_line(std::string_view& text, std::string& line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view taken = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    line.append(taken);
    if (taken.ends_with('\r')) taken.remove_suffix(1);
    return taken.ends_with('\\');
}

bool opens_block(std::string_view name) { return name == "for" || name == "repeat" || name == "if"; }

}  // namespace

std::vector<SceneSection> find_sections(std::string_view text) {
    std::vector<SceneSection> sections;
    std::uint32_t number = 1;
    std::size_t depth = 0;
    bool joined = false;
    while (!text.empty()) {
        if (depth == 0 && !joined) {
            sections.push_back({number, {}});
        } else {
            sections.back().text += '\n';
        }
        std::string line;
        const bool begins = !joined;
        joined = take_line(text, line);
        ++number;
        sections.back().text += line;
        const SceneStatement* statement = begins ? find_statement(line) : nullptr;
        if (statement == nullptr) continue;
        if (opens_block(statement->name)) ++depth;
        if (statement->name == "end" && depth > 0) --depth;
    }
    return sections;
}

std::string run_section(Scene& scene, std::string_view text, std::uint32_t line, const std::string& source,
                        const Context& ctx) {
    std::string output;
    for (const SceneLine& command : scene_lines(text, source)) {
        ctx.throw_if_cancelled();
        output += scene.run(command.text, fmt::format("{}:{}", source, command.number + line - 1), ctx);
    }
    scene.finish();
    return output;
}

}  // namespace coppice
