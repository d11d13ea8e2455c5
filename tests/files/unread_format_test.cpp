#include "coppice/io/unread_format.h"

#include <gtest/gtest.h>

#include <string>

#include "coppice/io_points/reader.h"
#include "coppice/io_skeleton/reader.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;

std::string named(std::string_view bytes) { return std::string(unread_format(bytes).value_or("none")); }

TEST(UnreadFormats, AreReportedWithTheirRemedy) {
    EXPECT_EQ(named("ncols 4\nnrows 3\nxllcorner 0\n1 2 3 4\n").find("an ESRI ASCII grid"), 0u);
    EXPECT_EQ(named("NCOLS        4\r\nNROWS 3\r\n").find("an ESRI ASCII grid"), 0u);
    EXPECT_EQ(named("; V3 text file\n(ImageCoords)\n").find("a Neurolucida tracing"), 0u);
    EXPECT_EQ(
        named("\n;one\n;two\n( (Color Blue)\n  (Axon)\n  (1 2 3 0.5)\n)\n").find("a Neurolucida tracing"),
        0u);
    EXPECT_NE(named("(\"CellBody\" (CellBody) (0 0 0 1))").find("convert it to SWC"), std::string::npos);
    EXPECT_EQ(named("<?xml version=\"1.0\"?>\n<mbf version=\"4.0\">").find("a Neurolucida XML tracing"), 0u);
    const std::string hdf = "\x89HDF\r\n\x1a\n";
    EXPECT_EQ(named(hdf + "points structure").find("a neuron in the HDF5 format of MorphIO"), 0u);
    EXPECT_EQ(named(hdf + "other").find("an HDF5 file"), 0u);
    EXPECT_EQ(named(std::string("SQLite format 3\0", 16)).find("an SQLite database"), 0u);
}

TEST(UnreadFormats, ExcludeReadableFiles) {
    for (const char* text :
         {"", "1 2 3\n", "# ncols nrows\n1 2 3\n", "(1,2,3)\n", "\"x\" \"y\" \"z\"\n1 2 3\n", "{}", "<rsml>",
          "ncols 1 2\n", "; a comment\n1 2 3\n"}) {
        EXPECT_EQ(unread_format(text), std::nullopt) << text;
    }
}

TEST(UnreadFormats, AreRejectedByTheReaders) {
    const std::string tracing = "( (Color Blue)\n  (Axon)\n  (1 2 3 0.5)\n)\n";
    EXPECT_EQ(error_of<Unsupported>([&] {
                  parse_skeleton(tracing, "cell.asc");
              }).find("cell.asc: it is a Neurolucida"),
              0u);
    EXPECT_EQ(error_of<Unsupported>([&] {
                  parse_points(tracing, "cell.asc");
              }).find("cell.asc: it is a Neurolucida"),
              0u);
    EXPECT_EQ(error_of<Unsupported>([] { parse_skeleton("\x1f\x8b", "tree.swc"); }),
              "tree.swc: it is compressed by gzip; unpack it first: gunzip FILE");
    // MATLAB writes HDF5 too.
    EXPECT_NE(error_of<Unsupported>([] { parse_skeleton("\x89HDF\r\n\x1a\n", "qsm.mat"); }).find("-v7"),
              std::string::npos);
}

}  // namespace
}  // namespace coppice
