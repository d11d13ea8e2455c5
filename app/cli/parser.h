#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "command.h"

namespace coppice::cli {

/// The command line of the program. Only this class uses the library that parses it.
class Parser {
  public:
    /// Stores a reference to the commands.
    explicit Parser(std::span<const Command> commands);
    ~Parser();
    Parser(const Parser&) = delete;
    Parser& operator=(const Parser&) = delete;

    /// Result of parsing: a command to run, with its options stored and listed in `given`; or no command and
    /// a text to print.
    struct Request {
        const Command* command = nullptr;
        GivenOptions given;
        std::vector<std::filesystem::path> further = {};  ///< further inputs of a command with `many`
        std::string text;
    };
    /// Throws UsageError with the most similar name for unknown words.
    Request parse(std::span<const char* const> arguments);

  private:
    struct Program;
    /// Returns the help of a command, with all options or the common ones; of the program if the topic is
    /// empty. The object cannot parse afterwards.
    std::string format_help(const std::string& topic, bool all);
    /// The same for the words after `coppice help`.
    std::string help_on(std::span<const char* const> words);

    std::unique_ptr<Program> program_;
};

}  // namespace coppice::cli
