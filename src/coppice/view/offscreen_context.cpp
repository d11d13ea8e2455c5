#include "coppice/view/offscreen_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <array>
#include <cstring>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/system/process.h"

namespace coppice {
namespace {

constexpr EGLint kMaxDevices = 64;

bool has_word(const char* words, const char* word) {
    return words != nullptr && std::strstr(words, word) != nullptr;
}

// The function loader ends the program if a library is missing; therefore this is checked before.
void check_libraries() {
    if (has_shared_library("libEGL.so.1") &&
        (has_shared_library("libOpenGL.so.0") || has_shared_library("libGL.so.1")))
        return;
    throw Unsupported(
        "OpenGL is not available: libEGL is not found; install it (Debian: apt install libegl1 libegl-mesa0 "
        "libgl1-mesa-dri, or the driver of the GPU), or draw with coppice render");
}

// The displays of devices; GPUs before software.
std::vector<EGLDisplay> device_displays() {
    std::array<EGLDeviceEXT, kMaxDevices> devices{};
    EGLint count = 0;
    if (eglQueryDevicesEXT(kMaxDevices, devices.data(), &count) == EGL_FALSE) return {};
    std::vector<EGLDisplay> cards, software;
    for (EGLint i = 0; i < count; ++i) {
        EGLDeviceEXT const device = devices[static_cast<std::size_t>(i)];
        const char* const extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
        EGLDisplay const display = eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
        auto& list = has_word(extensions, "EGL_MESA_device_software") ? software : cards;
        list.push_back(display);
    }
    cards.insert(cards.end(), software.begin(), software.end());
    return cards;
}

// The possible displays of a context.
std::vector<EGLDisplay> candidates() {
    const char* const known = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    std::vector<EGLDisplay> out;
    if (has_word(known, "EGL_EXT_device_enumeration") && has_word(known, "EGL_EXT_platform_device"))
        out = device_displays();
    if (has_word(known, "EGL_MESA_platform_surfaceless"))
        out.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr));
    out.push_back(eglGetDisplay(EGL_DEFAULT_DISPLAY));
    return out;
}

EGLContext make_context(EGLDisplay display) {
    static constexpr std::array<EGLint, 7> kCore{EGL_CONTEXT_MAJOR_VERSION,
                                                 3,
                                                 EGL_CONTEXT_MINOR_VERSION,
                                                 3,
                                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                 EGL_NONE};
    static constexpr std::array<EGLint, 5> kAny{EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                                EGL_NONE};
    const char* const known = eglQueryString(display, EGL_EXTENSIONS);
    if (!has_word(known, "EGL_KHR_surfaceless_context")) return EGL_NO_CONTEXT;
    EGLConfig config = nullptr;
    EGLint found = 0;
    if (!has_word(known, "EGL_KHR_no_config_context") &&
        (eglChooseConfig(display, kAny.data(), &config, 1, &found) == EGL_FALSE || found == 0))
        return EGL_NO_CONTEXT;
    if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) return EGL_NO_CONTEXT;
    return eglCreateContext(display, config, EGL_NO_CONTEXT, kCore.data());
}

std::string gl_text(GLenum name) {
    const auto* const text = reinterpret_cast<const char*>(glGetString(name));
    return text != nullptr ? text : "";
}

}  // namespace

struct OffscreenContext::State {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
    std::string renderer, version;

    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() { close(); }

    bool open(EGLDisplay candidate) {
        if (candidate == EGL_NO_DISPLAY) return false;
        if (eglInitialize(candidate, nullptr, nullptr) == EGL_FALSE) return false;
        display = candidate;
        context = make_context(display);
        if (context == EGL_NO_CONTEXT ||
            eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_FALSE) {
            close();
            return false;
        }
        renderer = gl_text(GL_RENDERER);
        version = gl_text(GL_VERSION);
        return true;
    }

    void close() {
        if (display == EGL_NO_DISPLAY) return;
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
        eglTerminate(display);
        display = EGL_NO_DISPLAY;
        context = EGL_NO_CONTEXT;
    }
};

OffscreenContext::OffscreenContext() : state_(std::make_unique<State>()) {
    check_libraries();
    for (EGLDisplay const candidate : candidates())
        if (state_->open(candidate)) return;
    throw Unsupported(
        "OpenGL is not available: no driver provides OpenGL 3.3 without a window; install one (Debian: apt "
        "install libegl-mesa0 libgl1-mesa-dri, or the driver of the GPU), or draw with coppice render");
}

OffscreenContext::~OffscreenContext() = default;

const std::string& OffscreenContext::renderer() const { return state_->renderer; }
const std::string& OffscreenContext::version() const { return state_->version; }

}  // namespace coppice
