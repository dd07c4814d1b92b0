// SPDX-License-Identifier: BSD-3-Clause
#include "files/yaml_config.h"
#include "support/refused_file.h"

#include <gtest/gtest.h>

using namespace pcl_semantic;

namespace {

YamlMap
load(const std::string& text)
{
  const TemporaryFolder folder;
  return YamlMap::load(folder.write("a.yaml", text));
}

::testing::AssertionResult
refuses(const std::string& text, const std::string& part)
{
  return refusesFile("a.yaml", text, part, YamlMap::load);
}

template <typename T>
std::string
typeRefusal(const std::string& value)
{
  const YamlMap map = load("first: 1\nkey: " + value + "\n");
  return thrownMessage<BadInputException>([&] {
    T result{};
    map.get("key", result);
  });
}

} // namespace

TEST(YamlMap, ReadsEveryType)
{
  const YamlMap map =
      load("flag: true\ncount: -3\nsize: 1.5e-1\nname: a b\nids: [1, 2]\n"
           "sizes: [0.5, 2]\nnames:\n  - x\n  - y\n");
  EXPECT_TRUE(map.require<bool>("flag"));
  EXPECT_EQ(map.require<int>("count"), -3);
  EXPECT_EQ(map.require<double>("size"), 0.15);
  EXPECT_EQ(map.require<std::string>("name"), "a b");
  EXPECT_EQ(map.require<std::vector<int>>("ids"), (std::vector<int>{1, 2}));
  EXPECT_EQ(map.require<std::vector<double>>("sizes"), (std::vector<double>{0.5, 2.0}));
  EXPECT_EQ(map.require<std::vector<std::string>>("names"),
            (std::vector<std::string>{"x", "y"}));
  EXPECT_NO_THROW(map.refuseUnknownKeys());
  EXPECT_EQ(map.keys().size(), 7u);
  EXPECT_EQ(map.keys()[3], "name");
}

TEST(YamlMap, AMissingKeyLeavesTheValueAndAnUnknownOneIsNamedWithItsLine)
{
  const YamlMap map = load("a: 1\n");
  double value = 7.0;
  EXPECT_FALSE(map.get("b", value));
  EXPECT_EQ(value, 7.0);
  EXPECT_FALSE(map.has("b"));
  expectBadInput("voxel_size", [&] { map.require<double>("voxel_size"); });
  EXPECT_EQ(map.keys().size(), 1u);
  const YamlMap misspelt = load("# a comment\nvoxel_size: 0.1\n\nvoxle_size: 0.2\n");
  EXPECT_TRUE(misspelt.has("voxel_size"));
  expectBadInput("a.yaml line 4: key 'voxle_size'",
                 [&] { misspelt.refuseUnknownKeys(); });
}

TEST(YamlMap, NamesTheLineOfAWrongType)
{
  for (const std::string& message :
       {typeRefusal<double>("wide"), typeRefusal<double>("\"1,5\""),
        typeRefusal<double>("[1]"), typeRefusal<double>("1.5 m"),
        typeRefusal<int>("1.5"), typeRefusal<int>("99999999999"), typeRefusal<int>(""),
        typeRefusal<bool>("7"), typeRefusal<std::string>("[a]"),
        typeRefusal<std::string>(""), typeRefusal<std::vector<int>>("3"),
        typeRefusal<std::vector<int>>("[1, x]"),
        typeRefusal<std::vector<int>>("{a: 1}")}) {
    EXPECT_TRUE(holds(message, "a.yaml line 2"));
    EXPECT_TRUE(holds(message, "'key'"));
  }
}

TEST(YamlMap, AcceptsTheHeaderOfOpenCV)
{
  const YamlMap map = load("%YAML:1.0\r\n---\r\na: 1\r\nb: 2\r\n");
  EXPECT_EQ(map.require<int>("a"), 1);
  expectBadInput("a.yaml line 4", [&] { map.refuseUnknownKeys(); });
  EXPECT_EQ(load("%YAML 1.2\n---\na: 1\n").require<int>("a"), 1);
  EXPECT_EQ(load("\xEF\xBB\xBF%YAML:1.0\na: 1\n").require<int>("a"), 1);
}

TEST(YamlMap, RefusesWhatIsNoMapping)
{
  for (const char* const text :
       {"", "# only a comment\n", "---\n", "word\n", "- a\n- b\n"}) {
    const std::string message = thrownMessage<BadInputException>([&] { load(text); });
    EXPECT_TRUE(holds(message, "a.yaml")) << text;
    EXPECT_FALSE(holds(message, "line 0")) << text;
  }
}

TEST(YamlMap, NamesTheLineOfWhatCannotBeRead)
{
  for (const auto& [text, part] :
       {std::pair("a: 1\nb: 2\na: 3\n", "a.yaml line 3: key 'a'"),
        std::pair("? [a]\n: 1\n", "a.yaml"),
        std::pair("a: 1\n---\nb: 2\n", "a.yaml line 2"),
        std::pair("---\n---\nb: 2\n", "a.yaml line 2"),
        std::pair("a: 1\nb: [1, 2\nc: 3\n", "a.yaml line"),
        std::pair("a: 1\n  b: 2\n", "a.yaml line 2"),
        std::pair("a: *nowhere\n", "a.yaml line 1")})
    EXPECT_TRUE(refuses(text, part));
  EXPECT_TRUE(refuses("a: " + std::string(100000, '['), "a.yaml line"));
  EXPECT_NO_THROW(load("# a comment\n\n---\nb: 2\n"));
}

TEST(YamlMap, ListsAndMapsKeepTheirLines)
{
  const YamlMap map = load("list:\n  - {a: 1}\n  - {a: 2, b: 3}\nmap:\n  c: 4\n");
  const std::vector<YamlMap> list = map.requireList("list");
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[1].require<int>("a"), 2);
  expectBadInput("line 3", [&] { list[1].refuseUnknownKeys(); });
  EXPECT_EQ(map.requireMap("map").require<int>("c"), 4);
  EXPECT_TRUE(holds(map.requireMap("map").where("c"), "line 5"));
  thrownMessage<BadInputException>([&] { map.requireList("map"); });
  thrownMessage<BadInputException>([&] { map.requireMap("list"); });
  thrownMessage<BadInputException>([&] { map.requireList("none"); });
}
