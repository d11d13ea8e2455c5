#pragma once

#include <memory>
#include <string>

namespace coppice {

/// An OpenGL context without a window, by EGL: core profile 3.3 or later. It is current on the thread that
/// created it until its destruction; only one may exist at a time.
///
/// Displays are tried in this order: those of devices, GPUs before software; a surfaceless one; the default
/// one. Thus a GPU is used even if no user is logged in, and software (Mesa's llvmpipe) if there is no GPU.
class OffscreenContext {
  public:
    /// Throws Unsupported with the missing component if no such context is available.
    OffscreenContext();
    ~OffscreenContext();                                            ///< releases the context
    OffscreenContext(const OffscreenContext&) = delete;             ///< not copyable
    OffscreenContext& operator=(const OffscreenContext&) = delete;  ///< not copyable

    const std::string& renderer() const;  ///< name of the renderer from its vendor
    const std::string& version() const;   ///< of OpenGL, and of the driver

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace coppice
