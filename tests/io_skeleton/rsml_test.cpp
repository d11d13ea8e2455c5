#include <gtest/gtest.h>

#include <algorithm>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/skeleton/measure.h"
#include "coppice/system/file.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;

SkeletonFile read(const std::string& text, const ReadSkeletonOptions& options = {}) {
    return parse_skeleton(text, "t.rsml", options);
}

std::string make_rsml(std::string_view unit, std::string_view scene) {
    return fmt::format(
        "<?xml version='1.0' encoding='UTF-8'?>\n<rsml xmlns:po='http://x/po.dtd'>\n<metadata>{}"
        "<property-definitions><property-definition><label>diameter</label><unit>km</unit>"
        "</property-definition></property-definitions></metadata>\n<scene>{}</scene></rsml>",
        unit, scene);
}

std::string line(std::string_view points) {
    return fmt::format("<geometry><polyline>{}</polyline></geometry>", points);
}

constexpr std::string_view kMetres = "<unit>m</unit><resolution>1</resolution>";

TEST(Rsml, DrawingsAreRotatedUprightAndRootsAreConnected) {
    // Two pixels per centimetre. The lateral starts next to its parent, a third of the way down.
    const SkeletonFile file = read(make_rsml(
        "<unit>cm</unit><resolution>2</resolution>",
        "<plant ID='1'><root ID='a' po:accession='PO:1'>" +
            line("<point x='100' y='0'/><point x='100' y='60'/>") +
            "<functions><function name='diameter' domain='polyline'><sample>4</sample><sample value='2'/>"
            "</function></functions><root>" +
            line("<point x='104' y='20'/><point x='120' y='30'/>") + "</root></root></plant>"));
    EXPECT_EQ(file.format, "rsml");
    ASSERT_EQ(file.skeleton.size(), 5u);
    EXPECT_EQ(file.skeleton.tree_count(), 1u);
    const auto expect_at = [&](std::uint32_t node, Vec3 p) {
        EXPECT_NEAR(distance(file.skeleton.position(NodeId(node)), p), 0, 1e-6) << node;
    };
    expect_at(0, {0.5f, 0, 0});
    expect_at(1, {0.5f, 0, -0.1f});  // added where the lateral branches off
    expect_at(2, {0.5f, 0, -0.3f});
    expect_at(3, {0.52f, 0, -0.1f});
    expect_at(4, {0.6f, 0, -0.15f});
    EXPECT_EQ(file.skeleton.parent(NodeId(3)), NodeId(1));
    EXPECT_FLOAT_EQ(file.skeleton.radius(NodeId(0)), 0.01f);
    EXPECT_NEAR(file.skeleton.radius(NodeId(1)), 0.01f - 0.005f / 3, 1e-7);
    EXPECT_FLOAT_EQ(file.skeleton.radius(NodeId(4)), file.skeleton.radius(NodeId(3)));
    EXPECT_EQ(file.attribute("order")[4], 1);
    EXPECT_EQ(file.attribute("axis")[2], 0);
    ASSERT_EQ(file.notes.size(), 1u);
    EXPECT_EQ(file.notes[0], "the y axis of the file, which points down, was rotated to z");
}

TEST(Rsml, TheDirectionOfRootsAlongYIsDown) {
    const auto tip = [](std::string_view points) {
        const SkeletonFile file =
            read(make_rsml(kMetres, fmt::format("<plant><root>{}</root></plant>", line(points))));
        return file.skeleton.origin() + Vec3d(file.skeleton.position(NodeId(1)));
    };
    EXPECT_EQ(tip("<point x='0' y='0'/><point x='1' y='5'/>"), Vec3d(1, 0, -5));
    EXPECT_EQ(tip("<point x='0' y='0'/><point x='1' y='-5'/>"), Vec3d(1, 0, -5));
    EXPECT_EQ(tip("<point x='0' y='0' z='0'/><point x='1' y='5' z='0'/>"), Vec3d(1, 0, -5));
    EXPECT_EQ(tip("<point x='0' y='0' z='0'/><point x='1' y='5' z='2'/>"), Vec3d(1, 2, -5));
    EXPECT_EQ(tip("<point x='0' y='0' z='0'/><point x='1' y='-5' z='2'/>"), Vec3d(1, -2, -5));
    EXPECT_EQ(tip("<point x='0' y='0' z='0'/><point x='1' y='2' z='-5'/>"), Vec3d(1, 2, -5));
}

TEST(Rsml, ConvertsUnits) {
    const auto length = [](const std::string& metadata) {
        const SkeletonFile file =
            read(make_rsml(metadata, "<plant><root>" + line("<point x='0' y='0'/><point x='0' y='300'/>") +
                                         "</root></plant>"));
        return std::pair(measure(file.skeleton).length, file.notes.size());
    };
    // Without radii there is a note in addition to that about the rotated axis.
    EXPECT_NEAR(length("<unit>inch</unit><resolution>300.0</resolution>").first, 0.0254, 1e-7);
    EXPECT_NEAR(length("<unit> Inches </unit><resolution>300</resolution>").first, 0.0254, 1e-7);
    EXPECT_NEAR(length("<unit>m</unit><resolution>0.0001</resolution>").first, 0.03, 1e-7);
    EXPECT_NEAR(length("<unit>mm</unit><resolution>0.05</resolution>").first, 0.015, 1e-7);
    EXPECT_NEAR(length("<unit>mm</unit><resolution>20</resolution>").first, 0.015, 1e-7);
    EXPECT_NEAR(length("<unit>um</unit><resolution>50</resolution>").first, 0.015, 1e-7);
    EXPECT_NEAR(length("<unit>cm</unit><resolution>0</resolution>").first, 3, 1e-6);
    EXPECT_EQ(length("<unit>cm</unit>").second, 2u);
    EXPECT_EQ(length("<unit>pixel</unit><resolution>1</resolution>"), std::pair(300.0, std::size_t{3}));
    EXPECT_EQ(length(""), std::pair(300.0, std::size_t{3}));
}

TEST(Rsml, ParentNodesMayCountFromZeroOrOne) {
    const auto parent_z = [](int number) {
        const std::string stem =
            line("<point x='0' y='0' z='0'/><point x='0' y='0' z='-1'/><point x='0' y='0' z='-2'/>");
        const SkeletonFile file = read(make_rsml(
            kMetres,
            fmt::format("<plant><root>{}<root><properties><parent-node value='{}'/></properties>{}</root>"
                        "</root></plant>",
                        stem, number, line("<point x='0' y='0' z='-1'/><point x='1' y='0' z='-1'/>"))));
        EXPECT_EQ(file.skeleton.size(), 4u);
        return file.skeleton.position(file.skeleton.parent(NodeId(3))).z;
    };
    EXPECT_EQ(parent_z(1), -1);
    EXPECT_EQ(parent_z(2), -1);
    EXPECT_EQ(parent_z(-1), -1);  // specifies none: the closest
    EXPECT_EQ(parent_z(99), -1);
}

TEST(Rsml, ReadsFunctionsOfAllDomains) {
    const SkeletonFile file = read(make_rsml(
        kMetres,
        "<plant><root>" +
            line("<point x='0' y='0' z='0'/><point x='0' y='0' z='-1'/><point x='0' y='0' z='-4'/>") +
            "<functions><function name='diameter' domain='length'><sample position='4' value='0.2'/>"
            "<sample position='0' value='0.6'/></function>"
            "<function name='Age-Days' domain='uniform'><sample>0</sample><sample>4</sample>"
            "<sample>8</sample></function>"
            "<function name='hair'><sample>1</sample></function>"
            "</functions></root></plant>"));
    EXPECT_FLOAT_EQ(file.skeleton.radius(NodeId(0)), 0.3f);
    EXPECT_FLOAT_EQ(file.skeleton.radius(NodeId(1)), 0.25f);
    EXPECT_FLOAT_EQ(file.skeleton.radius(NodeId(2)), 0.1f);
    ASSERT_EQ(file.attribute("age_days").size(), 3u);
    EXPECT_EQ(file.attribute("age_days")[1], 2);
    EXPECT_TRUE(file.attribute("hair").empty()) << "it is not known everywhere";
}

TEST(Rsml, ReadsUnusualFiles) {
    // Capitals, a namespace for everything, CR LF, comments, annotations with points, empty and single lines,
    // a spline in addition to the line, several plants, a root within one without points.
    const SkeletonFile file = read(
        "\xEF\xBB\xBF<?xml version='1.0' encoding='windows-1252'?>\r\n<!-- <rsml> -->\r\n<!DOCTYPE RSML>\r\n"
        "<r:RSML xmlns:r='x'><r:Metadata><r:Unit>M</r:Unit></r:Metadata><r:Scene>\r\n"
        "<r:Plant><r:Root><r:Geometry><r:rootnavspline><r:point x='9' y='9'/></r:rootnavspline>"
        "<r:Polyline><r:Point X='0' Y='0' Z='0'/><r:Point X='0' Y='0' Z='-2'/></r:Polyline></r:Geometry>"
        "<r:Root><r:Root><r:Geometry><r:Polyline><r:Point X='0' Y='0' Z='-1'/><r:Point X='1' Y='0' Z='-1'/>"
        "</r:Polyline></r:Geometry></r:Root></r:Root><r:annotations><r:annotation name='\xE9'>"
        "<r:point x='7' y='7'/></r:annotation></r:annotations></r:Root></r:Plant>\r\n"
        "<r:Plant><r:Root><r:Geometry><r:Polyline/></r:Geometry></r:Root>"
        "<r:Root><r:Geometry><r:Polyline><r:Point X='5' Y='0' "
        "Z='0'/></r:Polyline></r:Geometry></r:Root></r:Plant>"
        "</r:Scene></r:RSML>",
        {.format = SkeletonFormat::automatic, .default_radius = 0.1f});
    EXPECT_EQ(file.skeleton.size(), 5u);
    EXPECT_EQ(file.skeleton.tree_count(), 2u);
    EXPECT_EQ(file.report.total(), 0u);
}

TEST(Rsml, RootsOfAPlantThatStartTogetherAreOneTree) {
    const std::string two = "<root>" + line("<point x='0' y='0' z='0'/><point x='0' y='0' z='-1'/>") +
                            "</root><root>" + line("<point x='0' y='0' z='0'/><point x='1' y='0' z='-1'/>") +
                            "</root>";
    EXPECT_EQ(read(make_rsml(kMetres, "<plant>" + two + "</plant>")).skeleton.tree_count(), 1u);
    EXPECT_EQ(read(make_rsml(kMetres, "<plant>" + two + "</plant><plant>" + two + "</plant>"))
                  .skeleton.tree_count(),
              2u);
    EXPECT_EQ(read(make_rsml(kMetres, two)).skeleton.tree_count(), 1u) << "straight in the scene";
}

TEST(Rsml, ReportsErrors) {
    const auto error = [](const std::string& text) { return error_of([&] { read(text); }); };
    EXPECT_EQ(error("<rsml>\n<scene><plant>\n"), "t.rsml:3: this is not valid XML: no element found");
    EXPECT_EQ(error("<html></html>"), "t.rsml:1: this XML is not RSML: it starts with 'html'");
    EXPECT_EQ(error("<rsml/>"), "t.rsml: there are no nodes: no root of a plant has a polyline with points");
    EXPECT_EQ(error(make_rsml(kMetres, "<root>" + line("\n<point x='1'/>") + "</root>")),
              "t.rsml:5: a point has no y");
    EXPECT_EQ(error(make_rsml(kMetres, "<root>" + line("<point x='1' y='1,5'/>") + "</root>")),
              "t.rsml:4: the y of a point is '1,5', which is not a number");
    EXPECT_EQ(error(make_rsml(kMetres, "<root>" + line("<point x='1' y='nan'/>") + "</root>")),
              "t.rsml, line 4: a coordinate is not a finite number");
    EXPECT_EQ(error("<!DOCTYPE rsml [\n<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;'>]><rsml>&b;</rsml>"),
              "t.rsml:2: the DOCTYPE declares entities, which RSML does not use; remove the declaration");
}

TEST(Rsml, ReadsDeeplyNestedAndTangledFiles) {
    std::string deep;
    for (int i = 0; i < 100'000; ++i) deep += "<root>";
    deep += line("<point x='0' y='0'/><point x='0' y='1'/>");
    for (int i = 0; i < 100'000; ++i) deep += "</root>";
    EXPECT_EQ(read(make_rsml(kMetres, deep)).skeleton.size(), 2u);
    // A line that fills a cube at random, and as many laterals.
    std::string knot, laterals;
    std::uint32_t random = 1;
    const auto number = [&] { return (random = random * 1664525u + 1013904223u) >> 8; };
    for (int i = 0; i < 20'000; ++i) {
        knot += fmt::format("<point x='{}' y='{}' z='{}'/>", number(), number(), number());
        laterals += "<root>" +
                    line(fmt::format("<point x='{}' y='{}' z='{}'/>", number(), number(), number())) +
                    "</root>";
    }
    const SkeletonFile file =
        read(make_rsml(kMetres, "<plant><root>" + line(knot) + laterals + "</root></plant>"));
    EXPECT_EQ(file.skeleton.tree_count(), 1u);
    EXPECT_GE(file.skeleton.size(), 39'000u);
}

TEST(Rsml, IsRecognizedByItsContent) {
    EXPECT_EQ(format_of_content("<?xml version='1.0'?>\n<rsml>"), SkeletonFormat::rsml);
    EXPECT_EQ(format_of_content("<!-- a <b> -->\n<r:RSML xmlns:r='x'>"), SkeletonFormat::rsml);
    EXPECT_EQ(format_of_content("<?xml version='1.0'?><svg/>"), std::nullopt);
    EXPECT_EQ(format_of_content("<?xml"), std::nullopt);
    EXPECT_EQ(format_of_content("<"), std::nullopt);
    EXPECT_EQ(format_of_extension("a.RSML"), SkeletonFormat::rsml);
}

TEST(Rsml, StopsWhenCancelled) {
    std::stop_source stop;
    stop.request_stop();
    const std::string text =
        make_rsml(kMetres, "<plant><root>" + line("<point x='0' y='0'/>") + "</root></plant>");
    EXPECT_THROW(parse_skeleton(text, "t.rsml", {}, {.stop = stop.get_token()}), Cancelled);
}

}  // namespace
}  // namespace coppice
