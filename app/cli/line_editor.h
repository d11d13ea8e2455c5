#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace coppice::cli {

/// Reads lines: with editing, history and completion by the tab key when both standard input and output are
/// terminals, else plainly.
class LineEditor {
  public:
    /// `complete` gives what the last word of an unfinished line may become.
    using Complete = std::function<std::vector<std::string>(std::string_view line)>;

    LineEditor(std::string prompt, Complete complete);
    ~LineEditor();
    LineEditor(const LineEditor&) = delete;
    LineEditor& operator=(const LineEditor&) = delete;

    bool interactive() const { return terminal_ != nullptr; }

    /// Stands before the lines from now on, on terminals.
    void set_prompt(std::string prompt);

    /// A line without its end; nothing when the input has ended. A plain line is cut at 1 MiB.
    std::optional<std::string> next();

  private:
    struct Terminal;
    std::optional<std::string> next_plain();

    std::unique_ptr<Terminal> terminal_;
};

}  // namespace coppice::cli
