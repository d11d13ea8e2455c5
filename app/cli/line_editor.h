#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace coppice::cli {

/// Reads lines. Provides editing, history and completion by the tab key when standard input and output are
/// both terminals.
class LineEditor {
  public:
    /// `complete` returns the possible completions of the last word of an unfinished line.
    using Complete = std::function<std::vector<std::string>(std::string_view line)>;

    LineEditor(std::string prompt, Complete complete);
    ~LineEditor();
    LineEditor(const LineEditor&) = delete;
    LineEditor& operator=(const LineEditor&) = delete;

    bool interactive() const { return terminal_ != nullptr; }

    /// Sets the prompt that is shown on terminals.
    void set_prompt(std::string prompt);

    /// Returns a line without its line end; nullopt at the end of the input. On other inputs than terminals,
    /// lines are cut at 1 MiB.
    std::optional<std::string> next();

  private:
    struct Terminal;
    std::optional<std::string> next_plain();

    std::unique_ptr<Terminal> terminal_;
};

}  // namespace coppice::cli
