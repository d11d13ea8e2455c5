#include "coppice/scene/species.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "coppice/growth/size.h"
#include "coppice/scene/scene.h"

namespace coppice {
namespace {

/// Returns the scene of a species after growth, without surface and leaves, which need more time.
Scene grow_species(const TreeSpecies& species, int age) {
    Scene scene({.variables = {{"age", std::to_string(age)}, {"season", "summer"}}});
    std::string text(species.scene);
    text.resize(text.find("\nmaterial ") + 1);
    scene.run_text(text, std::string(species.name));
    return scene;
}

const Skeleton& tree_of(const Scene& scene) {
    return std::get<Skeleton>(scene.state().objects.at({ObjectKind::skeleton, "tree"})->value);
}

TEST(Species, are_sorted_and_titled) {
    ASSERT_FALSE(tree_species().empty());
    EXPECT_TRUE(std::ranges::is_sorted(tree_species(), {}, &TreeSpecies::name));
    for (const TreeSpecies& species : tree_species()) {
        EXPECT_FALSE(species.title.empty()) << species.name;
        EXPECT_FALSE(species.title.starts_with('#')) << species.name;
        EXPECT_FALSE(species.title.ends_with('.')) << species.name;
    }
    EXPECT_EQ(find_tree_species("oak")->title, "Pedunculate oak, Quercus robur");
    EXPECT_FALSE(find_tree_species("lamp"));
}

/// Heights and diameters at 10, 40 and 80 years of open-grown trees, as the species' comments state them.
TEST(Species, grow_to_their_size) {
    const Scene ten = grow_species(*find_tree_species("oak"), 10);
    EXPECT_NEAR(measure_size(tree_of(ten)).height, 4, 0.2);
    EXPECT_NEAR(measure_size(tree_of(ten)).dbh, 0.05, 0.005);
    const Scene eighty = grow_species(*find_tree_species("oak"), 80);
    EXPECT_NEAR(measure_size(tree_of(eighty)).height, 21, 1);
    EXPECT_NEAR(measure_size(tree_of(eighty)).dbh, 0.7, 0.05);
}

TEST(Species, grow_at_any_age) {
    for (const TreeSpecies& species : tree_species()) {
        for (const int age : {1, 3, 200}) {
            const Scene scene = grow_species(species, age);
            EXPECT_GT(tree_of(scene).size(), 1u) << species.name << " at " << age;
        }
    }
}

}  // namespace
}  // namespace coppice
