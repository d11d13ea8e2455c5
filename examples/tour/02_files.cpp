// Converts between files: the extensions select the formats.

#include <cstdio>
#include <string>

#include "coppice/io_mesh/writer.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/measure.h"

int main() {
    const coppice::SkeletonFile file = coppice::read_skeleton("oak.swc");
    std::printf("read as %s, %u repairs\n", file.format.c_str(), file.report.total());
    for (const std::string& note : file.notes) std::printf("note: %s\n", note.c_str());

    const coppice::SkeletonMeasures oak = coppice::measure(file.skeleton);
    std::printf("%u segments, %u tips, %.1f m of branches\n", oak.segments, oak.tips, oak.length);

    const coppice::MeshResult result = coppice::mesh_skeleton(file.skeleton);
    coppice::write_mesh("oak.glb", result.quads().mesh);        // triangles, Y up, for viewers
    coppice::write_mesh("oak.ply", result.quads().mesh);        // quads
    coppice::write_cage("oak.usda", result.quads().cage.cage);  // for subdivision by the reader
    std::printf("%zu quads written\n", result.quads().mesh.quads.size());
}
