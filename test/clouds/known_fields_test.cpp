// SPDX-License-Identifier: BSD-3-Clause

// Fields of points under other names and with other number types.

#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/files/cloud_file.h>

#include <sstream>
#include <vector>

namespace pcl_semantic {

namespace {

struct Field {
  std::string name, type; // of .ply: uchar, ushort, uint, int, float, double
};

using Fields = std::vector<Field>;

// x y z and further fields as an ascii file, of two points.
std::string
plyOf(const Fields& fields, const std::string& first, const std::string& second)
{
  std::string text = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n"
                     "property float y\nproperty float z\n";
  for (const Field& field : fields)
    text += "property " + field.type + " " + field.name + "\n";
  return text + "end_header\n1 2 3 " + first + "\n4 5 6 " + second + "\n";
}

std::string
pcdOf(const Fields& fields, const std::string& first, const std::string& second)
{
  std::string names = "FIELDS x y z", sizes = "SIZE 4 4 4", types = "TYPE F F F";
  for (const auto& [name, type] : fields) {
    names += " " + name;
    const bool is_float = type == "float" || type == "double";
    types += is_float ? " F" : type == "int" ? " I" : " U";
    sizes += type == "uchar"    ? " 1"
             : type == "ushort" ? " 2"
             : type == "double" ? " 8"
                                : " 4";
  }
  return "VERSION 0.7\n" + names + "\n" + sizes + "\n" + types +
         "\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n1 2 3 " + first + "\n4 5 6 " +
         second + "\n";
}

// Expectations about a file of either format.
template <typename Check>
void
inBothFormats(const Fields& fields, const std::string& first, const std::string& second,
              Check&& check, const LabelMapping* mapping = nullptr)
{
  const TemporaryFolder folder;
  for (const std::string& path :
       {folder.write("a.pcd", pcdOf(fields, first, second)),
        folder.write("a.ply", plyOf(fields, first, second))}) {
    SCOPED_TRACE(path + " " + (fields.empty() ? "" : fields[0].name));
    check(readLabelledCloud(path, mapping));
  }
}

const Fields
red_green_blue(const std::string& type)
{
  return {{"red", type}, {"green", type}, {"blue", type}};
}

} // namespace

TEST(KnownFields, ReadsLabelsUnderTheirUsualNames)
{
  for (const char* const name : {"label", "scalar_Label", "scalar_label", "Label",
                                 "labels", "semantic", "Semantic", "class", "sem_class",
                                 "category", "classification", "scalar_Classification"})
    inBothFormats({{name, "uchar"}}, "2", "7", [&](const LabelledCloud& cloud) {
      ASSERT_TRUE(cloud.has_labels);
      EXPECT_EQ((*cloud.cloud)[0].label, 2u);
      EXPECT_EQ((*cloud.cloud)[1].label, 7u);
      EXPECT_TRUE(cloud.table.doubts.empty());
    });
  inBothFormats({{"class", "uchar"}, {"label", "uchar"}}, "2 3", "7 8",
                [&](const LabelledCloud& cloud) {
                  EXPECT_EQ((*cloud.cloud)[1].label, 8u) << "label comes first";
                  ASSERT_EQ(cloud.table.doubts.size(), 1u);
                  EXPECT_TRUE(holds(cloud.table.doubts[0],
                                    "field 'class' is not read as labels: 'label' is"));
                });
  inBothFormats({{"class", "uchar"}, {"label", "uchar"}}, "0 3", "8 8",
                [&](const LabelledCloud& cloud) {
                  EXPECT_TRUE(cloud.table.doubts.empty()) << "it says nothing else";
                });
}

TEST(KnownFields, DoubtsLabelsThatItDoesNotUnderstand)
{
  struct Case {
    Field field;
    std::string value, doubt;
  };
  for (const Case& each : std::vector<Case>{
           {{"gt_label", "uchar"},
            "2",
            "field 'gt_label' is not read as labels; expected"},
           {{"class", "float"}, "0.5", "field 'class' is not read as labels: they are"},
           {{"classification", "ushort"}, "300", "not all are 0 to 255"}})
    inBothFormats({each.field}, each.value, "1", [&](const LabelledCloud& cloud) {
      EXPECT_FALSE(cloud.has_labels);
      ASSERT_EQ(cloud.table.doubts.size(), 1u);
      EXPECT_TRUE(holds(cloud.table.doubts[0], each.doubt));
    });
  inBothFormats(
      {{"instance", "uint"}, {"measured", "float"}}, "2 3", "7 8",
      [&](const LabelledCloud& cloud) { EXPECT_TRUE(cloud.table.doubts.empty()); });
}

// The upper 16 bits are an instance, whatever the type; a float holds 24.
TEST(KnownFields, TakesInstancesOffLabels)
{
  LabelMapping mapping;
  mapping.set(40, 3);
  mapping.set(10, 1);
  struct Case {
    std::string type, first, second;
  };
  for (const Case& each : std::vector<Case>{
           {"uint", "458762", "2621480"},    // 7 << 16 | 10, 40 << 16 | 40
           {"int", "458762", "-1673527256"}, // 40000 << 16 | 40, with a sign
           {"double", "458762", "2621440040"},
           {"float", "458762", "2621480"}}) {
    inBothFormats(
        {{"label", each.type}}, each.first, each.second,
        [&](const LabelledCloud& cloud) {
          EXPECT_EQ((*cloud.cloud)[0].label, 1u) << each.type;
          EXPECT_EQ((*cloud.cloud)[1].label, 3u) << each.type;
        },
        &mapping);
    inBothFormats({{"label", each.type}}, each.first, each.second,
                  [&](const LabelledCloud& cloud) {
                    EXPECT_EQ((*cloud.cloud)[0].label, 10u) << each.type;
                    EXPECT_EQ((*cloud.cloud)[1].label, 40u) << each.type;
                  });
  }
  EXPECT_TRUE(mapping.lacking().empty());
  inBothFormats(
      {{"label", "int"}}, "-1", "41",
      [&](const LabelledCloud& cloud) {
        EXPECT_EQ((*cloud.cloud)[0].label, kUnlabelled);
      },
      &mapping);
  inBothFormats(
      {{"label", "int"}}, "-1", "-7",
      [&](const LabelledCloud& cloud) {
        EXPECT_EQ((*cloud.cloud)[1].label, kUnlabelled);
      },
      &mapping);
  EXPECT_EQ(mapping.lacking(),
            (std::map<std::uint32_t, std::size_t>{{41, 2}, {65529, 2}}));
}

// Above 2^24 a float does not hold a class beside its instance: 300 << 16 | 1 is
// 300 << 16.
TEST(KnownFields, NamesFloatsThatLostTheClass)
{
  LabelMapping mapping;
  mapping.set(1, 1);
  for (const LabelMapping* const each :
       {(const LabelMapping*)nullptr, (const LabelMapping*)&mapping}) {
    const TemporaryFolder folder;
    for (const std::string& path :
         {folder.write("a.pcd", pcdOf({{"label", "float"}}, "1", "19660801")),
          folder.write("a.ply", plyOf({{"label", "float"}}, "1", "19660801"))})
      expectBadInput(
          path + ": field 'label': point 1 has 19660800, where single precision",
          [&] { readLabelledCloud(path, each); });
    const LabelledCloud without = readLabelledCloud(
        folder.write("b.pcd", pcdOf({{"scalar_Label", "float"}}, "1", "19660801")),
        each);
    EXPECT_FALSE(without.has_labels);
    ASSERT_EQ(without.table.doubts.size(), 1u);
    EXPECT_TRUE(holds(without.table.doubts[0],
                      "field 'scalar_Label' is not read as labels: point 1 has"));
    for (const char* const type : {"double", "uint", "int"})
      inBothFormats(
          {{"label", type}}, "1", "19660801",
          [&](const LabelledCloud& cloud) { EXPECT_EQ((*cloud.cloud)[1].label, 1u); },
          each);
  }
}

// High dynamic range, or a rounding error.
TEST(KnownFields, CutsOffColoursAboveWhite)
{
  for (const char* const bright : {"1.0001", "1.2", "37.5"})
    inBothFormats(red_green_blue("float"), std::string("1 0.5019608 ") + bright,
                  "0.25 0.25 0", [&](const LabelledCloud& cloud) {
                    ASSERT_TRUE(cloud.has_colour);
                    EXPECT_EQ((*cloud.cloud)[0].rgba & 0xFFFFFFu, 0xFF80FFu);
                    ASSERT_EQ(cloud.table.doubts.size(), 1u);
                    EXPECT_TRUE(holds(cloud.table.doubts[0],
                                      "field 'red': 1 of its colours are above 1"));
                  });
  inBothFormats(red_green_blue("float"), "200.5 100.25 0.5", "1 1 90",
                [&](const LabelledCloud& cloud) {
                  EXPECT_EQ((*cloud.cloud)[1].rgba & 0xFFFFFFu, 0x01015Au);
                });
}

TEST(KnownFields, ReadsColoursOfAnyForm)
{
  struct Case {
    Fields fields;
    std::string first, second;
    std::uint32_t rgb;
  };
  for (const Case& each : std::vector<Case>{
           {red_green_blue("uchar"), "255 128 0", "1 1 1", 0xFF8000},
           {red_green_blue("ushort"), "65535 32896 0", "257 257 257", 0xFF8000},
           {red_green_blue("ushort"), "255 128 0", "1 1 1", 0xFF8000},
           {red_green_blue("float"), "1 0.5019608 0", "0 0 0", 0xFF8000},
           {red_green_blue("double"), "255 128 0", "1 1 1", 0xFF8000},
           {{{"r", "uchar"}, {"g", "uchar"}, {"b", "uchar"}},
            "255 128 0",
            "1 1 1",
            0xFF8000},
           {{{"diffuse_red", "uchar"},
             {"diffuse_green", "uchar"},
             {"diffuse_blue", "uchar"}},
            "255 128 0",
            "1 1 1",
            0xFF8000},
           {{{"Rf", "float"}, {"Gf", "float"}, {"Bf", "float"}}, // CloudCompare
            "1 0.5019608 0",
            "0 0 0",
            0xFF8000},
           {{{"scalar_R", "float"}, {"scalar_G", "float"}, {"scalar_B", "float"}},
            "255 128 0",
            "1 1 1",
            0xFF8000}})
    inBothFormats(
        each.fields, each.first, each.second, [&](const LabelledCloud& cloud) {
          ASSERT_TRUE(cloud.has_colour);
          EXPECT_EQ((*cloud.cloud)[0].rgba & 0xFFFFFFu, each.rgb);
          EXPECT_TRUE(cloud.table.doubts.empty());
          const auto has = [&](const char* name) {
            return cloud.table.find(name) >= 0;
          };
          EXPECT_TRUE(each.fields[0].type == "uchar" || has("red") || has("scalar_R") ||
                      has("scalar_r") || has("Rf") || has("rf"))
              << "the fields of the file stay";
        });
  for (const Case& each :
       std::vector<Case>{{red_green_blue("float"), "-1 0 0", "0 0 0", 0},
                         {red_green_blue("float"), "300.5 0 0", "0 0 0", 0},
                         {{{"red", "uchar"}, {"green", "uchar"}}, "1 2", "1 2", 0},
                         {{{"bgr", "uint"}}, "1", "1", 0},
                         {{{"colour_of_paint", "uint"}}, "1", "1", 0}})
    inBothFormats(each.fields, each.first, each.second,
                  [&](const LabelledCloud& cloud) {
                    EXPECT_FALSE(cloud.has_colour);
                    ASSERT_EQ(cloud.table.doubts.size(), 1u);
                    EXPECT_TRUE(holds(cloud.table.doubts[0],
                                      "is not read as colour; expected rgb"));
                  });
}

TEST(KnownFields, ReadsProbabilitiesOfOneFieldAClass)
{
  for (const std::string name : {"probability_", "prob", "scalar_Prob_"})
    for (const int first : {0, 1}) {
      const Fields fields = {{name + std::to_string(first), "float"},
                             {name + std::to_string(first + 1), "float"}};
      inBothFormats(fields, "0.25 0.75", "1 0", [&](const LabelledCloud& cloud) {
        ASSERT_EQ(cloud.distributions.classes(), 2);
        EXPECT_EQ(cloud.distributions.matrix()(1, 0), 0.75f);
        EXPECT_EQ((*cloud.cloud)[0].label, 2u);
      });
      inBothFormats(fields, "2.5 0.75", "1 0", [&](const LabelledCloud& cloud) {
        EXPECT_EQ(cloud.distributions.classes(), 0);
        ASSERT_EQ(cloud.table.doubts.size(), 1u);
        EXPECT_TRUE(holds(cloud.table.doubts[0], "is not read as probabilities"));
      });
      Fields with_gap = fields;
      with_gap.push_back({name + std::to_string(first + 3), "float"});
      inBothFormats(with_gap, "0.25 0.75 0", "1 0 0", [&](const LabelledCloud& cloud) {
        EXPECT_EQ(cloud.distributions.classes(), 0);
        ASSERT_EQ(cloud.table.doubts.size(), 1u);
        EXPECT_TRUE(holds(cloud.table.doubts[0], "a number is missing"));
      });
    }
}

} // namespace pcl_semantic
