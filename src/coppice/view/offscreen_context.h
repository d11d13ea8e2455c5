#pragma once

#include <memory>
#include <string>

namespace coppice {

/// An OpenGL context without a window, by EGL: core profile 3.3 or later. It is current on the thread that
/// made it, until it goes; only one at a time.
///
/// Displays are tried in this order: those of devices, graphics cards before software; one without surfaces;
/// the default one. So a card is used also where nobody is logged in, and software (Mesa's llvmpipe) where
/// there is none.
class OffscreenContext {
  public:
    /// Throws Unsupported where no such context can be had, saying what is missing.
    OffscreenContext();
    ~OffscreenContext();                                            ///< gives it back
    OffscreenContext(const OffscreenContext&) = delete;             ///< it is one
    OffscreenContext& operator=(const OffscreenContext&) = delete;  ///< it is one

    const std::string& renderer() const;  ///< what draws, as its maker calls it
    const std::string& version() const;   ///< of OpenGL, and of the driver

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace coppice
