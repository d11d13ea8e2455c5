#pragma once

#include <memory>
#include <span>
#include <string>

#include "command.h"

namespace coppice::cli {

/// The command line of the whole program. It is the only part that knows the library that reads it.
class Parser {
  public:
    /// Refers to the commands.
    explicit Parser(std::span<const Command> commands);
    ~Parser();
    Parser(const Parser&) = delete;
    Parser& operator=(const Parser&) = delete;

    /// What the words ask for: a command to run, its options stored and named in `given`, or none and a text
    /// to print.
    struct Request {
        const Command* command = nullptr;
        GivenOptions given;
        std::string text;
    };
    /// Throws UsageError with the nearest spelling.
    Request parse(std::span<const char* const> arguments);

  private:
    struct Program;
    /// The help of a command, with all options or the common ones, after which nothing can be parsed; of the
    /// whole program where the topic is empty.
    std::string help_of(const std::string& topic, bool all);
    /// The same for the words after `coppice help`.
    std::string help_on(std::span<const char* const> words);

    std::unique_ptr<Program> program_;
};

}  // namespace coppice::cli
