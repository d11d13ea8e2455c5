#include "coppice/studio/document/document.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stop_token>

#include "coppice/base/error.h"
#include "coppice/scene/save.h"
#include "studio/heap_bytes.h"

namespace coppice {
namespace {

const Context kQuiet;

/// Returns all objects with their numbers: sufficient to distinguish two scenes.
std::string all_of(const Scene& scene) {
    std::string out = make_recipe(scene.state());
    for (const auto& [name, object] : scene.state().objects)
        out += std::string(name_of(name.first)) + " " + name.second + "\n" + describe_object(*object);
    return out;
}

std::string all_of(const std::string& text) {
    Scene scene;
    scene.run_text(text, "again");
    return all_of(scene);
}

Document make_document(const std::string& text) {
    Document document;
    document.set_text(text, kQuiet);
    return document;
}

TEST(Document, TextEqualsTheInput) {
    const std::string text = "# two balls\nsphere a\n\nsphere b radius=2\n";
    Document document = make_document(text);
    EXPECT_EQ(document.text(), text);
    EXPECT_EQ(document.ran(), 4u);
    EXPECT_EQ(document.scene().state().objects.size(), 2u);
    EXPECT_EQ(document.statements()[3].line, 4u);
}

TEST(Document, InsertsALineBeforeTheFirstUseOfItsObject) {
    Document document = make_document("sphere a\nsphere b center=1,0,0\nunion a b both\nsphere c\n");
    EXPECT_EQ(document.run("translate a 0 0 1", Document::Name{ObjectKind::solid, "a"}, kQuiet), 1u);
    EXPECT_EQ(document.run("translate c 0 0 1", Document::Name{ObjectKind::solid, "c"}, kQuiet), 5u);
    EXPECT_EQ(
        document.text(),
        "sphere a\ntranslate a 0 0 1\nsphere b center=1,0,0\nunion a b both\nsphere c\ntranslate c 0 0 1\n");
    EXPECT_EQ(all_of(document.scene()), all_of(document.text()));
}

TEST(Document, RejectsAFailingLineAndPreservesTheRest) {
    Document document = make_document("sphere a\n");
    const std::uint64_t revision = document.revision();
    EXPECT_THROW(document.run("sphere b radius=-1", {}, kQuiet), InvalidInput);
    EXPECT_EQ(document.text(), "sphere a\n");
    EXPECT_EQ(document.revision(), revision);
    EXPECT_TRUE(document.undo_names(10).size() == 1);
}

TEST(Document, StopsAtAFailingStatementAndPreservesTheRest) {
    Document document = make_document("sphere a\nsphere b\nunion a b c\n");
    document.set_text("sphere a\nunion a b c\nsphere d\n", kQuiet);
    ASSERT_TRUE(document.failure());
    EXPECT_EQ(document.failure()->statement, 1u);
    EXPECT_EQ(document.failure()->line, 2u);
    EXPECT_EQ(document.ran(), 1u);
    EXPECT_EQ(document.size(), 3u);
    document.run("sphere b", {}, kQuiet);  // inserted before the failed statement, which then runs
    EXPECT_FALSE(document.failure());
    EXPECT_EQ(document.text(), "sphere a\nsphere b\nunion a b c\nsphere d\n");
    EXPECT_EQ(document.ran(), 4u);
}

TEST(Document, RunsToACursorAndBack) {
    Document document = make_document("sphere a\nsphere b\nsphere c\n");
    document.run_to(1, kQuiet);
    EXPECT_EQ(document.scene().state().objects.size(), 1u);
    EXPECT_EQ(document.size(), 3u);
    document.run("sphere z", {}, kQuiet);
    EXPECT_EQ(document.text(), "sphere a\nsphere z\nsphere b\nsphere c\n");
    EXPECT_EQ(document.ran(), 2u);
    document.run_to(100, kQuiet);
    EXPECT_EQ(document.scene().state().objects.size(), 4u);
}

TEST(Document, RunsABlockAsOneStepAndUndoesItOnFailure) {
    Document document = make_document("sphere a\n");
    EXPECT_THROW(document.run("for i in 1..3\n  sphere b${i} radius=${2 - i}\nend", {}, kQuiet),
                 InvalidInput);
    EXPECT_EQ(document.scene().state().objects.size(), 1u);
    document.set_text("sphere a\nfor i in 1..3\n  sphere b${i} radius=${2 - i}\nend\n", kQuiet);
    ASSERT_TRUE(document.failure());
    EXPECT_EQ(document.scene().state().objects.size(), 1u);
}

TEST(Document, CancellationChangesNothing) {
    Document document = make_document("sphere a\n");
    std::stop_source stop;
    stop.request_stop();
    Context ctx;
    ctx.stop = stop.get_token();
    EXPECT_THROW(document.run("sphere b", {}, ctx), Cancelled);
    EXPECT_EQ(document.text(), "sphere a\n");
    EXPECT_EQ(document.scene().state().objects.size(), 1u);
}

TEST(Document, RerunsStatementsThatReadAFile) {
    Document document = make_document("sphere a\n");
    EXPECT_FALSE(document.rerun("tree.swc", kQuiet));
    document.set_text("sphere a\nsphere b  # tree.swc\n", kQuiet);
    const ObjectPtr before = document.scene().state().objects.at({ObjectKind::solid, "b"});
    EXPECT_TRUE(document.rerun("tree.swc", kQuiet));
    const ObjectPtr after = document.scene().state().objects.at({ObjectKind::solid, "b"});
    EXPECT_NE(after, before);
    // Undo restores versions that read the current content of the file.
    document.run("sphere c", {}, kQuiet);
    document.undo(1, kQuiet);
    EXPECT_EQ(document.scene().state().objects.at({ObjectKind::solid, "b"}), after);
    EXPECT_EQ(document.undo_names(10).size(), 2u);
}

TEST(Document, UndoStoresThousandsOfChangesOfALongText) {
    // 1 MB in 300 statements, one of which changes each time.
    std::vector<std::string> lines;
    for (int i = 0; i < 300; ++i) lines.push_back("# " + std::to_string(i) + std::string(3400, 'x'));
    const auto text = [&] {
        std::string out;
        for (const std::string& line : lines) out += line + "\n";
        return out;
    };
    Document document(SceneSettings{}, {.texts = std::uint64_t{6} << 20});
    document.begin_with(text(), "");
    const std::uint64_t before = test::heap_bytes();
    for (std::size_t i = 0; i < 800; ++i) {
        lines[(i * 7) % lines.size()] = "# changed " + std::to_string(i) + std::string(3400, 'y');
        document.set_text(text(), kQuiet);
    }
    // All of these changes take 2.8 MB, of which a quarter of the limit has room for 1.5; whole texts would
    // be 800.
    EXPECT_LT(test::heap_bytes() - before, std::uint64_t{6} << 20);
    EXPECT_GT(document.undo_names(10'000).size(), 400u);
    EXPECT_LT(document.undo_names(10'000).size(), 500u);
    const std::string last = document.text();
    document.undo(400, kQuiet);
    document.redo(400, kQuiet);
    EXPECT_EQ(document.text(), last);
    EXPECT_THROW(document.set_text("# " + std::string(800'000, 'x') + "\n# " + std::string(800'000, 'y') +
                                       "\n# " + std::string(800'000, 'z') + "\n# " +
                                       std::string(800'000, 'w') + "\n# " + std::string(999'000, 'v') + "\n",
                                   kQuiet),
                 InvalidInput);
    EXPECT_EQ(document.text(), last);
}

TEST(Document, DiscardsTheOldestChangesWithoutRoom) {
    Document document(SceneSettings{}, {.texts = 400'000});
    for (int i = 0; i < 200; ++i)
        document.set_text("# " + std::to_string(i) + std::string(2000, 'x') + "\n", kQuiet);
    const std::size_t left = document.undo_names(1000).size();
    // A quarter of the limit, divided by slightly more than 2000 bytes each.
    EXPECT_GT(left, 30u);
    EXPECT_LT(left, 50u);
    document.undo(left, kQuiet);
    EXPECT_EQ(document.text().find("# " + std::to_string(199 - left)), 0u);
}

TEST(Document, StoredStatesAreLimited) {
    // Points of 1.2 MB each in different versions; all would be 36 MB.
    Document document(SceneSettings{}, {.states = std::uint64_t{4} << 20});
    document.run("sphere a", {}, kQuiet);
    const std::uint64_t before = test::heap_bytes();
    for (int i = 0; i < 30; ++i) {
        document.set_text(
            "sphere a\npointset generate a uniform count=100000 seed=" + std::to_string(i) + "\n", kQuiet);
    }
    EXPECT_LT(test::heap_bytes() - before, std::uint64_t{8} << 20);
    document.undo(29, kQuiet);
    EXPECT_EQ(document.text(), "sphere a\npointset generate a uniform count=100000 seed=0\n");
    EXPECT_EQ(document.scene().state().objects.size(), 2u);
}

TEST(Document, StoredOutputIsLimited) {
    Document document;
    document.run("sphere a", {}, kQuiet);
    document.run("repeat 3000\n  describe a\nend", {}, kQuiet);
    EXPECT_GT(document.statements()[1].message.size(), 60'000u);
    EXPECT_LT(document.statements()[1].message.size(), 70'000u);
}

TEST(Document, JoinsRelatedChanges) {
    Document document;
    const Document::TextChange drag{.count = {}, .name = "radius", .by = "hand", .joins = true};
    document.set_text("sphere a\nsphere b\n", kQuiet);
    document.set_text("sphere a radius=2\nsphere b\n", drag, kQuiet);
    document.set_text("sphere a radius=3\nsphere b radius=2\n", drag, kQuiet);
    Document::TextChange other = drag;
    other.by = "another";
    document.set_text("sphere a radius=4\nsphere b radius=2\n", other, kQuiet);
    EXPECT_EQ(document.undo_names(10), (std::vector<std::string>{"change of the text", "radius", "radius"}));
    document.undo(2, kQuiet);
    EXPECT_EQ(document.text(), "sphere a\nsphere b\n");
    document.redo(1, kQuiet);
    EXPECT_EQ(document.text(), "sphere a radius=3\nsphere b radius=2\n");
}

// For any edits, the text reproduces the same scene from the start.
TEST(Document, RandomChangesMatchRunningTheText) {
    std::mt19937 random(7);
    const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    for (int round = 0; round < 20; ++round) {
        Document document;
        std::vector<std::string> texts{""};
        std::size_t at = 0;
        const auto changed = [&] {
            texts.resize(at + 1);
            texts.push_back(document.text());
            ++at;
        };
        for (int i = 0; i < 60; ++i) {
            const std::string name(1, static_cast<char>('a' + below(4)));
            const std::string other(1, static_cast<char>('a' + below(4)));
            const std::array<std::string, 7> lines{
                "sphere " + name + " radius=0." + std::to_string(1 + below(8)),
                "translate " + name + " 0 0 1",
                "union " + name + " " + other + " u",
                "pointset generate " + name + " poisson count=20",
                "repeat 2\n  scale " + name + " ${random(0.9, 1.1)}\nend",
                "limb t 0,0,0 0,0,1 0,0.5,2",
                "edit bend t 1 30"};
            const std::size_t what = below(11);
            try {
                if (what < 7) {
                    document.run(lines[what],
                                 Document::Name{what > 4 ? ObjectKind::skeleton : ObjectKind::solid,
                                                what > 4 ? "t" : name},
                                 kQuiet);
                    changed();
                } else if (what == 7 && at > 0) {
                    const std::size_t n = 1 + below(at);
                    document.undo(n, kQuiet);
                    at -= n;
                    EXPECT_EQ(document.text(), texts[at]);
                } else if (what == 8 && at + 1 < texts.size()) {
                    document.redo(1, kQuiet);
                    EXPECT_EQ(document.text(), texts[++at]);
                } else if (what == 9) {
                    document.run_to(below(document.size() + 1), kQuiet);
                } else if (what == 10) {
                    document.run_to(document.size(), kQuiet);
                }
            } catch (const InvalidInput&) {
                EXPECT_EQ(document.text(), texts[at]);
            }
        }
        document.run_to(document.size(), kQuiet);
        std::string ran;
        for (std::size_t i = 0; i < document.ran(); ++i) ran += document.statements()[i].text + "\n";
        EXPECT_EQ(all_of(document.scene()), all_of(ran));
    }
}

TEST(Document, DiscardsThousandsOfVersionsWithoutRecursion) {
    std::string text;
    for (int i = 0; i < 50'000; ++i) text += "# nothing\n";
    Document document = make_document(text);
    document.set_text("sphere a\n", kQuiet);
    EXPECT_EQ(document.ran(), 1u);
}

}  // namespace
}  // namespace coppice
