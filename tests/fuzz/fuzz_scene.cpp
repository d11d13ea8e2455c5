// Runs arbitrary bytes as a scene without files and with little memory: every command succeeds or throws
// coppice::Error with a sentence of one line. A recipe of the objects must create the same number of objects
// again.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "coppice/base/error.h"
#include "coppice/scene/reference.h"
#include "coppice/scene/save.h"
#include "coppice/scene/scene.h"

namespace {

const coppice::SceneSettings kSettings{.max_memory = 2, .files = false, .outputs = false, .max_lines = 60};
constexpr std::size_t kMaxLines = 40;

void require(bool condition) {
    if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    coppice::Scene scene(kSettings);
    const coppice::Context ctx{.threads = 1};
    try {
        const auto lines = coppice::scene_lines(text, "fuzz");
        for (std::size_t i = 0; i < lines.size() && i < kMaxLines; ++i) {
            coppice::completions(lines[i].text, scene.state());
            try {
                scene.run(lines[i].text, "fuzz", ctx);
            } catch (const coppice::Error& error) {
                require(std::string_view(error.what()).find('\n') == std::string_view::npos);
            }
        }
        coppice::Scene again(kSettings);
        again.run_text(coppice::make_recipe(scene.state()), "recipe", ctx);
        require(again.state().objects.size() == scene.state().objects.size());
    } catch (const coppice::Error&) {  // expected for an invalid scene
    }
    return 0;
}
