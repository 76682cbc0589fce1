// Entries by name (nw/base/Registry.nw).
#include "malus/base/Registry.hpp"

#include <gtest/gtest.h>

using namespace malus;

namespace {
struct Thing {
  std::string name;
  int number;
};
const bool registered[]{Registry<Thing>::add([] {
                          return Thing{"pear", 2};
                        }),
                        Registry<Thing>::add([] {
                          return Thing{"apple", 1};
                        })};
struct Other {
  std::string name;
};
}  // namespace

TEST(RegistryIdentity, EntriesAreSortedAndFoundByName) {
  EXPECT_TRUE(registered[0] && registered[1]);
  ASSERT_EQ(Registry<Thing>::entries().size(), 2u);
  EXPECT_EQ(Registry<Thing>::entries()[0].name, "apple");
  EXPECT_EQ(Registry<Thing>::find("pear", {}, "a thing").number, 2);
  EXPECT_TRUE(Registry<Other>::entries().empty());  // control: each kind has its own list
}

TEST(RegistryIdentity, AnUnknownNameIsAnsweredWithTheNearest) {
  try {
    Registry<Thing>::find("pera", {"s.json", 3, "sky.model"}, "a thing");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "s.json:3: sky.model = pera: is not a thing of malus; did you mean pear? choose from: "
        "apple, pear");
  }
}
