// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/label_set.h>

#include <gtest/gtest.h>

using namespace pcl_semantic;

namespace {

std::vector<LabelClass>
classesNamed(int count)
{
  std::vector<LabelClass> classes(count);
  for (int i = 0; i < count; ++i)
    classes[i].name = "class" + std::to_string(i + 1);
  return classes;
}

} // namespace

TEST(LabelSet, LabelsCountFromOne)
{
  const LabelSet set(
      {{"road", {1, 2, 3}, false, false}, {"sky", {4, 5, 6}, true, false}});
  EXPECT_EQ(set.size(), 2);
  EXPECT_EQ(set[1].name, "road");
  EXPECT_EQ(set[2].name, "sky");
  EXPECT_TRUE(set[2].sky);
  EXPECT_EQ(set[2].colour[2], 6);
  EXPECT_EQ(set.find("road"), 1);
  EXPECT_EQ(set.find("sky"), 2);
}

TEST(LabelSet, ZeroIsUnlabelledAndBlack)
{
  const LabelSet set(classesNamed(3));
  EXPECT_EQ(set[kUnlabelled].name, "unlabelled");
  EXPECT_EQ(set[kUnlabelled].colour, (std::array<std::uint8_t, 3>{0, 0, 0}));
  EXPECT_EQ(set.find("no such class"), kUnlabelled);
}

TEST(LabelSet, RefusesLabelsBeyondItsClasses)
{
  const LabelSet set(classesNamed(3));
  const std::string message =
      thrownMessage<InvalidParameterException>([&] { (void)set[4]; });
  EXPECT_TRUE(holds(message, "4"));
  EXPECT_TRUE(holds(message, "3"));
}

TEST(LabelSet, HasOneTo255Classes)
{
  thrownMessage<InvalidParameterException>([] { LabelSet(std::vector<LabelClass>()); });
  const LabelSet largest(classesNamed(255));
  EXPECT_EQ(largest.size(), 255);
  EXPECT_EQ(largest[255].name, "class255");
  EXPECT_EQ(largest.find("class255"), 255);
  expectBadParameter("256", [] { LabelSet(classesNamed(256)); });
}

TEST(LabelSet, RefusesEmptyAndRepeatedNames)
{
  auto classes = classesNamed(3);
  classes[2].name = "class1";
  expectBadParameter("class1", [&] { LabelSet set(classes); });
  for (const std::string& name :
       {std::string(), std::string("a\nb"), std::string("a\0b", 3),
        std::string("\x1b[2J"), std::string(101, 'a')}) {
    classes[2].name = name;
    const std::string message =
        thrownMessage<InvalidParameterException>([&] { LabelSet set(classes); });
    EXPECT_EQ(message.find_first_of("\n\x1b"), std::string::npos);
  }
  classes[2].name = std::string(100, 'a');
  EXPECT_EQ(LabelSet(classes).size(), 3);
}

TEST(LabelMapping, MapsWhatIsSetAndNothingElse)
{
  LabelMapping mapping;
  EXPECT_EQ(mapping(0), kUnlabelled);
  EXPECT_EQ(mapping(4000000000u), kUnlabelled);
  mapping.set(259, 6);
  mapping.set(40, 3);
  EXPECT_EQ(mapping(259), 6);
  EXPECT_EQ(mapping(40), 3);
  EXPECT_EQ(mapping(41), kUnlabelled);
  EXPECT_EQ(mapping(260), kUnlabelled);
  mapping.set(40, 5);
  EXPECT_EQ(mapping(40), 5);
  expectBadParameter("65536", [&] { mapping.set(65536, 1); });
}

TEST(LabelMapping, TakesInstancesOffAndCountsWhatItLacks)
{
  LabelMapping mapping;
  mapping.set(40, 3);
  mapping.set(99, kUnlabelled);
  const LabelMapping copy = mapping;
  EXPECT_EQ(mapping(7u << 16 | 40u), 3);
  EXPECT_TRUE(textOfLacking(mapping, "m.yaml", "points").empty());
  for (const std::uint32_t number : {0u, 99u, 41u, 7u << 16 | 41u, 50u, 65535u})
    EXPECT_EQ(copy(number), kUnlabelled);
  EXPECT_EQ(mapping.lacking(),
            (std::map<std::uint32_t, std::size_t>{{41, 2}, {50, 1}, {65535, 1}}));
  EXPECT_EQ(textOfLacking(mapping, "m.yaml", "points"),
            "label mapping m.yaml lacks 3 numbers of the input: 41 (2 points), 50 (1), "
            "65535 (1): they count as unlabelled");
  EXPECT_TRUE(mapping.has(99));
  EXPECT_FALSE(mapping.has(0));
}
