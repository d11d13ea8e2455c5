#pragma once

#include <stdexcept>
#include <string>

namespace coppice {

/// Base of all errors that a user can cause and fix. The text is one sentence that names the file, line or
/// field, and the remedy.
class Error : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The data or an option is wrong. Exit code 3.
class InvalidInput : public Error {
  public:
    using Error::Error;
};

/// A file cannot be read or written. Exit code 4.
class IoError : public Error {
  public:
    using Error::Error;
};

/// The input is well-formed, but of a kind that is not handled. Exit code 3.
class Unsupported : public Error {
  public:
    using Error::Error;
};

/// Work was cancelled through `Context::stop` where no partial result makes sense. Exit code 130.
class Cancelled : public Error {
  public:
    Cancelled() : Error("interrupted") {}  ///< says "interrupted"
};

/// A documented precondition of the library was broken: a fault of the code that called it, not of its user,
/// so no `Error`. Thrown rather than printed or aborted with, because neither the streams nor the life of the
/// process are the library's; what does not catch it ends as usual, with the text from std::terminate.
class PreconditionBroken : public std::logic_error {
  public:
    using std::logic_error::logic_error;
};

/// Throws PreconditionBroken: "FILE:LINE: precondition broken: CONDITION".
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line);

}  // namespace coppice

/// A documented precondition that only code can break; checked in every build.
#define COPPICE_ASSERT(condition) \
    ((condition) ? static_cast<void>(0) : ::coppice::assertion_failed(#condition, __FILE__, __LINE__))
