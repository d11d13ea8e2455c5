// Options are plain structs that describe themselves: to JSON, from JSON, as a schema.

#include <cstdio>
#include <nlohmann/json.hpp>

#include "coppice/base/error.h"
#include "coppice/options/json.h"
#include "coppice/pipeline/mesh_skeleton.h"

int main() {
    coppice::MeshOptions options{.levels = 3};
    options.control.base = coppice::BaseShape::round;
    options.field.support = 2;

    const coppice::Json json = coppice::to_json(coppice::option_fields(options));
    std::printf("control: %s\n", json["control"].dump().c_str());

    // Missing members keep their values.
    coppice::MeshOptions read;
    const auto text = coppice::Json::parse(R"({"levels": 1, "control": {"tips": "flat"}})");
    coppice::from_json(text, coppice::option_fields(read), "my options");
    std::printf("levels %d, tips %s, base %s\n", read.levels, coppice::name_of(read.control.tips).data(),
                coppice::name_of(read.control.base).data());

    for (const char* wrong : {R"({"level": 1})", R"({"levels": 9})", R"({"control": {"tips": "pointed"}})"}) {
        try {
            coppice::from_json(coppice::Json::parse(wrong), coppice::option_fields(read), "my options");
        } catch (const coppice::InvalidInput& error) {
            std::printf("refused: %s\n", error.what());
        }
    }

    // The source of sliders and reference pages of front ends.
    coppice::ControlOptions defaults;
    for (const auto& field : coppice::make_schema(coppice::option_fields(defaults))) {
        std::printf("%s\n", field.dump().c_str());
    }
}
