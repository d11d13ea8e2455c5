// The content of a dropped file, by its name and its first bytes.
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { readdir, readFile } from "node:fs/promises";
import { join } from "node:path";
import { test } from "node:test";
import { bytesText, endingOf, freeFile, nameError, objectName, withEnding } from "../src/panels/files/folder";
import { contentOf, isTree, offContent, plyContent } from "../src/panels/files/kinds";

const text = (name: string, content: string) => contentOf(name, new Blob([content]));

test("the kind of a PLY file is detected by its header", () => {
    const header = (...elements: string[]) => `ply\nformat ascii 1.0\n${elements.map((one) => `element ${one}\nproperty float x\n`).join("")}end_header\n1 2 3`;
    assert.equal(plyContent(header("vertex 3", "face 1")), "mesh");
    assert.equal(plyContent(header("vertex 3", "edge 2")), "skeleton");
    assert.equal(plyContent(header("vertex 3", "face 0")), "points");
    assert.equal(plyContent(header("vertex 3", "face 0").replaceAll("\n", "\r\n")), "points");
    assert.equal(plyContent(header("vertex 3")), "points");
    assert.throws(() => plyContent("solid cube"), /not a PLY/);
});

test("an OFF file without faces is detected as points", () => {
    assert.equal(offContent("OFF\n# 9 9 9\n3 0 0\n0 0 0"), "points");
    assert.equal(offContent("OFF 8 6 12\n"), "mesh");
});

test("an OBJ file is a skeleton if its first element is a line, at any position", async () => {
    const vertices = "v 0.25 0.125 0.5\n".repeat(400_000); // 6.8 MB: more than one chunk
    assert.equal(await text("a.obj", `${vertices}l 1 2 3\nf 1 2 3\n`), "skeleton");
    assert.equal(await text("a.obj", `${vertices}f 1 2 3\nl 1 2\n`), "mesh");
    assert.equal(await text("a.obj", "# fl \nv 0 0 0\nvn 0 0 1\n"), "mesh");
});

test("tables of cylinders and nodes are detected as trees, other tables as points", () => {
    assert.ok(isTree("ID,parentID,startX,startY,startZ,endX,endY,endZ,radius\n"));
    assert.ok(isTree("start_x;start_y;start_z;axis_x;axis_y;axis_z;length;radius\n"));
    assert.ok(isTree("# of a scan\nx,y,z,radius,parent_id\n"));
    assert.ok(isTree("0.2 1.5 0 0 0 0 0 1 0 2\n")); // TreeQSM: the axis has length 1
    assert.ok(isTree("1 3 0 0 0 0.5 -1\n2 3 0 0 1 0.4 1\n"));
    assert.ok(!isTree("1 3 0 0 0 0.5 255\n2 3 0 0 1 0.4 254\n")); // points with additional columns: no row is the parent of another
    assert.ok(!isTree("0.2 1.5 0 0 0 0 0 2 0 2\n"));
    assert.ok(!isTree('"x" "y" "z"\n1 2 3\n'));
    assert.ok(!isTree("x y z radius_of_search\n1 2 3 4\n"));
    assert.ok(!isTree(""));
});

test("kinds are detected by endings and JSON fields; other files are rejected", async () => {
    assert.equal(await text("Oak.SWC", "1 1 0 0 0 1 -1"), "skeleton");
    assert.equal(await text("fork.sketch.json", "{}"), "sketch");
    assert.equal(await text("fork.json", '{"format": "coppice-sketch"}'), "sketch");
    assert.equal(await text("oak.json", '{"parent": [-1]}'), "skeleton");
    assert.equal(await text("side.JPG", "..."), "photograph");
    await assert.rejects(text("a.json", '{"asset": 1}'), /another program/);
    await assert.rejects(text("a.e57", "ASTM-E57"), /LAZ/);
    await assert.rejects(text("a.zip", "PK"), /unpack/);
    await assert.rejects(text("a.docx", "PK"), /not in a supported format/);
    await assert.rejects(text("a.swc", ""), /empty/);
});

test("names of objects are derived from file names", () => {
    assert.equal(endingOf("a/b.c/Fork.Sketch.JSON"), ".sketch.json");
    assert.equal(withEnding("tree", ".coppice"), "tree.coppice");
    assert.equal(withEnding("tree.COPPICE", ".coppice"), "tree.COPPICE");
    assert.equal(withEnding("tree.v2", ".coppice"), "tree.v2.coppice");
    assert.equal(freeFile("oak.swc", new Set(["oak.swc", "oak-2.swc"])), "oak-3.swc");
    assert.equal(objectName("scans/25 Höhe (2).laz"), "Hohe_2");
    assert.equal(objectName("1.swc"), "object");
    assert.equal(objectName("fork.sketch.json"), "fork");
    assert.equal(bytesText(999), "999 bytes");
    assert.equal(bytesText(1234567), "1.2 MB");
    assert.equal(bytesText(123_456_789), "123 MB");
    assert.equal(nameError("scans/oak.swc"), "");
    for (const wrong of ["", "/etc/passwd", "../a", "a//b", ".hidden", "C:\\a", "a\u0007"]) {
        assert.notEqual(nameError(wrong), "", wrong);
    }
});

// Files of other programs: next to the checkout, if available.
const kPlaces = ["../../shared/data", "../shared/data"].map((place) => join(process.cwd(), place));
const kData = kPlaces.find(existsSync);
const kHolds: Record<string, string> = {
    cloud: "points",
    closed_mesh: "mesh",
    mtg: "skeleton",
    qsm: "skeleton",
    rsml: "skeleton",
    swc: "skeleton",
    tree_mesh: "mesh",
};
const kOthers = new Map([
    ["archi_Tree_1_point_cloud.las", "points"],
    ["itsme_buttressed_tree_1_pc.txt", "points"],
    ["rtwig_cloud.txt", "points"],
    ["plantscan3d_A3B4.asc", "points"],
]);

test("files of other programs are detected", { skip: !kData && "these files do not exist here" }, async () => {
    for (const [folder, content] of Object.entries(kHolds)) {
        const names = await readdir(join(kData ?? "", folder));
        assert.ok(names.length > 0, folder);
        for (const name of names) {
            const data = new Blob([new Uint8Array(await readFile(join(kData ?? "", folder, name)))]);
            assert.equal(await contentOf(name, data), kOthers.get(name) ?? content, name);
        }
    }
});
