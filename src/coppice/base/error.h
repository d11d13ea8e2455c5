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

/// The data or an option is invalid. Exit code 3.
class InvalidInput : public Error {
  public:
    using Error::Error;
};

/// A file cannot be read or written. Exit code 4.
class IoError : public Error {
  public:
    using Error::Error;
};

/// The input is well-formed, but of an unsupported kind. Exit code 3.
class Unsupported : public Error {
  public:
    using Error::Error;
};

/// Work was cancelled through `Context::stop` without a useful partial result. Exit code 130.
class Cancelled : public Error {
  public:
    Cancelled() : Error("interrupted") {}  ///< its text is "interrupted"
};

/// A documented precondition of the library was broken: an error of the calling code, not of its user, and
/// therefore not an `Error`. Thrown instead of printed or aborted, because the library owns neither the
/// streams nor the process; if it is not caught, std::terminate prints its text.
class PreconditionBroken : public std::logic_error {
  public:
    using std::logic_error::logic_error;
};

/// Throws PreconditionBroken: "FILE:LINE: precondition broken: CONDITION".
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line);

}  // namespace coppice

/// Checks a documented precondition that only code can break, in every build.
#define COPPICE_ASSERT(condition) \
    ((condition) ? static_cast<void>(0) : ::coppice::assertion_failed(#condition, __FILE__, __LINE__))
