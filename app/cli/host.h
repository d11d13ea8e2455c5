#pragma once

#include <stop_token>
#include <string>
#include <string_view>

namespace coppice::cli {

class HeldObjects;

/// The surroundings of a command: the terminal of the program, or a program that calls the library.
class Host {
  public:
    virtual ~Host() = default;

    /// Returns the request to stop, for work that begins now.
    virtual std::stop_token stop_token() const = 0;
    /// Clears a request to stop, so that later work is not stopped.
    virtual void forget_stop() = 0;

    /// Outputs data, such as a table. Throws IoError on failure.
    virtual void print(std::string_view text) = 0;
    /// Outputs a message of one line.
    virtual void say(std::string_view message) = 0;

    virtual bool shows_progress() const = 0;  ///< whether show_progress() and finish() have an effect
    /// Shows the progress of a stage, from 0 to 1; the subject is the file of many that is processed, or
    /// empty.
    virtual void show_progress(const std::string& subject, const std::string& stage, float fraction) = 0;
    virtual void clear_progress() = 0;  ///< called at the end of each stage
    /// Shows the result of a command, and its seconds.
    virtual void finish(const std::string& summary, const std::string& seconds) = 0;

    /// [MiB] Limits the memory of the process, if it belongs to the command alone.
    virtual void limit_memory(int mebibytes, unsigned threads) = 0;

    /// Returns the objects in memory that are used like files; null if there are none.
    virtual HeldObjects* held_objects() = 0;
};

}  // namespace coppice::cli
