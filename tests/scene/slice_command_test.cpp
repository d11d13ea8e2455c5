#include <gtest/gtest.h>

#include "coppice/scene/scene.h"
#include "coppice/system/file.h"
#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

class SliceCommand : public test::FolderTest {
  protected:
    std::string run(const std::string& options) {
        const std::string path = quoted_word((folder_ / "s.png").string());
        return scene_.run("slice s " + path + " pixels=64 " + options);
    }
    std::string picture() const { return read_file(folder_ / "s.png"); }
    std::string refusal(const std::string& options) {
        return test::error_of<Error>([&] { run(options); });
    }
    void SetUp() override {
        FolderTest::SetUp();
        scene_.run_text("sphere s law=soft\npointset gen s count=60 distance=0.3", "x");
    }
    Scene scene_;
};

TEST_F(SliceCommand, DrawsAFieldWithItsIsolines) {
    // The field ends at 2 m, so that the image of 64 pixels is 4.32 m wide; isolines are from 0.1 to 0.9.
    const std::string message = run("");
    EXPECT_NE(message.find("field 0 to 0.99"), std::string::npos) << message;
    EXPECT_NE(message.find("9 isolines; a pixel is 0.0675 m"), std::string::npos) << message;
    EXPECT_EQ(picture().substr(1, 3), "PNG");
    EXPECT_NE(run("isoline=0.25 isoline=0.75 high=2").find("drawn from 0 to 2; 2 isolines"),
              std::string::npos);
    // Off the centre the values are smaller; a plane outside the field contains none.
    EXPECT_NE(run("at=0,1,0").find("field 0 to 0.49"), std::string::npos);
    EXPECT_NE(run("at=0,5,0").find("field 0 to 0,"), std::string::npos);
}

TEST_F(SliceCommand, DrawsTheRemainingDensity) {
    EXPECT_NE(run("of=density").find("density 0 to 1"), std::string::npos);
    const std::string whole = picture();
    EXPECT_NE(run("of=density points=s kernel=0.3,1").find("density 0 to 1"), std::string::npos);
    EXPECT_NE(picture(), whole);
    const std::string disks = picture();
    EXPECT_NE(run("of=density points=s kernel=0.3,1 dots=0.1").find("density"), std::string::npos);
    EXPECT_NE(picture(), disks);
    // Clusters: up to four times the density near one point.
    const std::string clusters = run("of=density points=s kernel=0.1,4 kernel=0.4,1");
    EXPECT_EQ(clusters.find("density 0 to 1,"), std::string::npos) << clusters;
    EXPECT_NE(run("of=density curve=0.6,2 curve=0.8,3").find("density 0 to 2.9"), std::string::npos);
    EXPECT_NE(run("of=density density=inverse").find("density 0 to 0.9"), std::string::npos);
    EXPECT_NE(picture(), whole);
}

TEST_F(SliceCommand, IsBitIdenticalForAnyNumberOfThreads) {
    std::vector<std::string> pictures;
    for (const unsigned threads : {1u, 7u}) {
        scene_.run("slice s " + quoted_word((folder_ / "s.png").string()) +
                       " of=density points=s kernel=0.3,2 kernel=0.6,1 pixels=100",
                   "", {.threads = threads});
        pictures.push_back(picture());
    }
    EXPECT_EQ(pictures[0], pictures[1]);
}

TEST_F(SliceCommand, RejectsInvalidInput) {
    EXPECT_NE(refusal("normal=0,0,0").find("normal="), std::string::npos);
    EXPECT_NE(refusal("kernel=0.3,1").find("of=density"), std::string::npos);
    EXPECT_NE(refusal("of=density kernel=0.3,1").find("points="), std::string::npos);
    EXPECT_NE(refusal("points=s").find("dots="), std::string::npos);
    EXPECT_NE(refusal("dots=1").find("points="), std::string::npos);
    EXPECT_NE(refusal("low=2").find("low=2"), std::string::npos);
    EXPECT_NE(refusal("low=2 high=1").find("above low="), std::string::npos);
    EXPECT_NE(refusal("every=1e-6").find("isolines"), std::string::npos);
    EXPECT_THROW(scene_.run("slice s s.jpg"), InvalidInput);
}

}  // namespace
}  // namespace coppice
