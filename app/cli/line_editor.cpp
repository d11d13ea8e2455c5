#include "line_editor.h"

#include <histedit.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace coppice::cli {
namespace {

constexpr int kHistoryLength = 1000;
constexpr std::size_t kLongestLine = std::size_t{1} << 20;

std::string common_beginning(const std::vector<std::string>& words) {
    std::string common = words.front();
    for (const std::string& word : words) {
        const auto differ = std::ranges::mismatch(common, word).in1;
        common.erase(differ, common.end());
    }
    return common;
}

}  // namespace

struct LineEditor::Terminal {
    Terminal(std::string prompt_, Complete complete_)
        : prompt(std::move(prompt_)), complete(std::move(complete_)) {
        line = el_init("coppice", stdin, stdout, stderr);
        past = history_init();
        HistEvent event;
        history(past, &event, H_SETSIZE, kHistoryLength);
        history(past, &event, H_SETUNIQUE, 1);
        el_set(line, EL_CLIENTDATA, this);
        el_set(line, EL_PROMPT, &show_prompt);
        el_set(line, EL_EDITOR, "emacs");
        el_set(line, EL_HIST, history, past);
        el_set(line, EL_ADDFN, "coppice-complete", "Complete a word", &complete_word);
        el_set(line, EL_BIND, "^I", "coppice-complete", nullptr);
        // While a line is being edited, Ctrl-C clears it; while a command runs, it stops the command.
        el_set(line, EL_SETTY, "-d", "-isig", nullptr);
        el_set(line, EL_BIND, "^C", "em-kill-line", nullptr);
    }
    ~Terminal() {
        history_end(past);
        el_end(line);
    }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    static Terminal& of(EditLine* line) {
        void* self = nullptr;
        el_get(line, EL_CLIENTDATA, &self);
        return *static_cast<Terminal*>(self);
    }

    static char* show_prompt(EditLine* line) { return of(line).prompt.data(); }

    static unsigned char complete_word(EditLine* line, int) {
        const LineInfo* info = el_line(line);
        const std::string_view typed(info->buffer, static_cast<std::size_t>(info->cursor - info->buffer));
        const auto words = of(line).complete(typed);
        if (words.empty()) return CC_REFRESH_BEEP;
        const std::size_t blank = typed.find_last_of(" \t");
        const std::size_t begun = typed.size() - (blank == typed.npos ? 0 : blank + 1);
        const std::string common = common_beginning(words);
        std::string more = common.size() > begun ? common.substr(begun) : std::string();
        if (words.size() == 1 && !common.ends_with('=') && !common.ends_with('@')) more += ' ';
        if (!more.empty()) return el_insertstr(line, more.c_str()) == 0 ? CC_REFRESH : CC_REFRESH_BEEP;
        std::fputc('\n', stdout);
        for (const std::string& word : words) std::fprintf(stdout, "%s  ", word.c_str());
        std::fputc('\n', stdout);
        return CC_REDISPLAY;
    }

    std::optional<std::string> next() {
        int count = 0;
        const char* text = el_gets(line, &count);
        if (text == nullptr || count <= 0) return {};
        std::string out(text, static_cast<std::size_t>(count));
        while (out.ends_with('\n') || out.ends_with('\r')) out.pop_back();
        if (out.find_first_not_of(" \t") != out.npos) {
            HistEvent event;
            history(past, &event, H_ENTER, out.c_str());
        }
        return out;
    }

    std::string prompt;
    Complete complete;
    EditLine* line;
    History* past;
};

LineEditor::LineEditor(std::string prompt, Complete complete) {
    if (isatty(STDIN_FILENO) != 0 && isatty(STDOUT_FILENO) != 0)
        terminal_ = std::make_unique<Terminal>(std::move(prompt), std::move(complete));
}

LineEditor::~LineEditor() = default;

void LineEditor::set_prompt(std::string prompt) {
    if (terminal_) terminal_->prompt = std::move(prompt);
}

std::optional<std::string> LineEditor::next() { return terminal_ ? terminal_->next() : next_plain(); }

std::optional<std::string> LineEditor::next_plain() {
    std::string line;
    for (int c = std::getchar(); c != EOF; c = std::getchar()) {
        if (c == '\n') return line;
        if (line.size() < kLongestLine) line += static_cast<char>(c);
    }
    if (line.empty()) return {};
    return line;
}

}  // namespace coppice::cli
