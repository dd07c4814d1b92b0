// SPDX-License-Identifier: BSD-3-Clause

// The rules of the sources: includes point downward, every source has its header, no
// compiler flag changes the instruction set, and comments and guides use plain phrases.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace fs = std::filesystem;

namespace {

const fs::path source_folder = PCL_SEMANTIC_SOURCE_DIR;

std::string
readText(const fs::path& path)
{
  std::ifstream stream(path);
  EXPECT_TRUE(stream) << path;
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

// A library of src/CMakeLists.txt.
struct Library {
  std::vector<std::string> modules; // lowest first
  std::set<std::string> below;      // libraries that it is linked with, and theirs
};

using Libraries = std::vector<std::pair<std::string, Library>>; // lowest first

const Library*
findLibrary(const Libraries& libraries, const std::string& name)
{
  for (const auto& [each, library] : libraries)
    if (each == name)
      return &library;
  return nullptr;
}

// What src/CMakeLists.txt calls pcl_semantic_library() with.
// \param[out] faults one for each link that points upward
Libraries
librariesOf(const std::string& cmake_text, std::vector<std::string>& faults)
{
  Libraries libraries;
  const std::regex call("pcl_semantic_library\\(([^)]*)\\)");
  for (std::sregex_iterator match(cmake_text.begin(), cmake_text.end(), call), end;
       match != end; ++match) {
    std::istringstream words((*match)[1]);
    std::string name, kind;
    words >> name;
    Library library;
    for (std::string word; words >> word;)
      if (word == "MODULES" || word == "PUBLIC" || word == "PRIVATE")
        kind = word;
      else if (kind == "MODULES")
        library.modules.push_back(word);
      else if (word.rfind("pcl_semantic::", 0) == 0) {
        const std::string linked = word.substr(word.rfind(':') + 1);
        library.below.insert(linked);
        if (const Library* const found = findLibrary(libraries, linked))
          library.below.insert(found->below.begin(), found->below.end());
        else
          faults.push_back(name + " is linked with " + linked + ", which is not below");
      }
    libraries.emplace_back(name, library);
  }
  return libraries;
}

const Libraries&
ourLibraries()
{
  static const Libraries libraries = [] {
    std::vector<std::string> unused;
    Libraries all = librariesOf(readText(source_folder / "src/CMakeLists.txt"), unused);
    Library apps{{"apps"}, {}};
    for (const auto& [name, library] : all)
      apps.below.insert(name);
    all.front().second.modules.insert(all.front().second.modules.begin(), "version.h");
    all.emplace_back("apps", apps);
    return all;
  }();
  return libraries;
}

// The library of a module and its place in it; an empty name: there is no such module.
std::pair<std::string, std::ptrdiff_t>
placeOf(const std::string& module)
{
  for (const auto& [name, library] : ourLibraries()) {
    const auto& modules = library.modules;
    const auto found = std::find(modules.begin(), modules.end(), module);
    if (found != modules.end())
      return {name, found - modules.begin()};
  }
  return {};
}

bool
isModule(const std::string& module)
{
  return !placeOf(module).first.empty();
}

// Whether files of a module may include those of another: of its library those before
// it, and all of the libraries below.
bool
isBelow(const std::string& module, const std::string& other)
{
  const auto [library, place] = placeOf(module);
  const auto [other_library, other_place] = placeOf(other);
  return library == other_library
             ? other_place <= place
             : findLibrary(ourLibraries(), library)->below.count(other_library) > 0;
}

// Why a file of `module` must not hold the include `name` (in <> or ""); empty if it
// may.
std::string
includeFault(const std::string& module, const std::string& name, bool quoted)
{
  static const std::regex ours("pcl_semantic/([^/]+)(/.*)?");
  if (name.find("..") != std::string::npos)
    return "leaves its folder";
  std::smatch match;
  if (!std::regex_match(name, match, ours)) {
    const std::string first = name.substr(0, name.find('/'));
    if (isModule(first) && first.size() < name.size()) { // of src/
      if (!quoted)
        return "expected quotes around it";
      return isBelow(module, first) ? "" : "is not below";
    }
    return quoted && module != "apps" && name == "tool.h" ? "belongs to apps" : "";
  }
  const std::string target = match[1];
  if (quoted)
    return "expected <> around it";
  if (!isModule(target))
    return "no such module";
  return isBelow(module, target) ? "" : "is not below";
}

// One line for every include of `text` that a file of `module` must not hold.
std::vector<std::string>
includeFaults(const std::string& module, const std::string& text)
{
  static const std::regex pattern("^\\s*#\\s*include\\s*([<\"])([^>\"]+)[>\"]");
  std::vector<std::string> faults;
  std::istringstream stream(text);
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    std::smatch match;
    if (!std::regex_search(line, match, pattern))
      continue;
    const std::string fault = includeFault(module, match[2], match[1] == "\"");
    if (!fault.empty())
      faults.push_back("line " + std::to_string(number) + ": " + match[2].str() + " " +
                       fault);
  }
  return faults;
}

// Flags that change the instruction set, outside of comments of a CMake file.
bool
hasInstructionSetFlag(const std::string& cmake_text)
{
  const std::string code =
      std::regex_replace(cmake_text, std::regex("#[^\n]*"), std::string());
  return std::regex_search(code, std::regex("-m(avx|arch|fma|tune)"));
}

bool
isCode(const fs::path& path)
{
  const fs::path extension = path.extension();
  return extension == ".h" || extension == ".hpp" || extension == ".cpp";
}

// The code of the library and the programs, by module.
std::multimap<std::string, fs::path>
codeFiles()
{
  std::multimap<std::string, fs::path> files;
  for (const char* const root : {"include/pcl_semantic", "src", "apps"})
    for (const auto& entry : fs::recursive_directory_iterator(source_folder / root)) {
      if (!entry.is_regular_file() || !isCode(entry.path()))
        continue;
      const fs::path relative = fs::relative(entry.path(), source_folder / root);
      const std::string module =
          root == std::string("apps") ? "apps" : relative.begin()->string();
      files.emplace(module, entry.path());
    }
  return files;
}

} // namespace

TEST(SourceRules, TheCheckerFindsBadIncludes)
{
  const auto count = [](const std::string& module, const std::string& text) {
    return includeFaults(module, text).size();
  };
  // upward
  EXPECT_EQ(count("core", "#include <pcl_semantic/map/semantic_voxel_map.h>\n"), 1u);
  EXPECT_EQ(count("map", "int a;\n #  include <pcl_semantic/pipeline/a.h>\n"), 1u);
  EXPECT_EQ(count("crf", "#include <pcl_semantic/filters/semantic_crf.h>\n"), 1u);
  // beside
  EXPECT_EQ(count("map", "#include <pcl_semantic/cliques/clique_generator.h>\n"), 1u);
  EXPECT_EQ(count("crf", "#include <pcl_semantic/files/npy_file.h>\n"), 1u);
  EXPECT_EQ(count("io", "#include <pcl_semantic/evaluation/confusion_matrix.h>\n"), 1u);
  EXPECT_EQ(count("map", "#include <pcl_semantic/filters/semantic_crf.h>\n"), 1u);
  EXPECT_EQ(count("pipeline", "#include <pcl_semantic/capture/live_capture.h>\n"), 1u);
  EXPECT_EQ(count("map", "#include \"pipeline/a.h\"\n"), 1u);
  EXPECT_EQ(count("map", "#include \"stereo/a.h\"\n"), 1u);
  // around the rules
  EXPECT_EQ(count("map", "#include <core/a.h>\n"), 1u);
  EXPECT_EQ(count("core", "#include \"pcl_semantic/core/label_set.h\"\n"), 1u);
  EXPECT_EQ(count("map", "#include \"../stereo/sgbm.h\"\n"), 1u);
  EXPECT_EQ(count("io", "#include \"tool.h\"\n"), 1u);
  EXPECT_EQ(count("io", "#include <apps/tool.h>\n"), 1u);
  EXPECT_EQ(count("io", "#include <pcl_semantic/attic/a.h>\n"), 1u);
  // allowed
  EXPECT_EQ(count("map", "#include \"map/a.h\"\n"), 0u); // from its kernels
  EXPECT_EQ(count("evaluation",
                  "#include <pcl_semantic/map/a.h>\n#include <pcl_semantic/core/b.h>\n"
                  "#include <pcl_semantic/files/c.h>\n#include <pcl/io/pcd_io.h>\n"
                  "#include <pcl_semantic/evaluation/d.h>\n#include \"kernels/e.h\"\n"
                  "#include \"core/f.h\"\n"
                  "#include <map>\n#include <pcl_semantic/version.h>\n"),
            0u);
  EXPECT_EQ(count("apps", "#include \"tool.h\"\n#include <pcl_semantic/io/a.h>\n"), 0u);
}

TEST(SourceRules, LinksPointDownward)
{
  std::vector<std::string> faults;
  librariesOf("pcl_semantic_library(a MODULES b PUBLIC pcl_semantic::c)\n"
              "pcl_semantic_library(c MODULES d PRIVATE pcl_semantic::a)\n",
              faults);
  EXPECT_EQ(faults, std::vector<std::string>{"a is linked with c, which is not below"});
  faults.clear();
  const Libraries libraries =
      librariesOf(readText(source_folder / "src/CMakeLists.txt"), faults);
  EXPECT_EQ(libraries.size(), 7u);
  EXPECT_EQ(faults, std::vector<std::string>());
}

TEST(SourceRules, IncludesPointDownward)
{
  const auto files = codeFiles();
  ASSERT_GT(files.size(), 20u);
  for (const auto& [module, path] : files) {
    EXPECT_TRUE(isModule(module))
        << path << ": module '" << module << "' is not in the design";
    for (const std::string& fault : includeFaults(module, readText(path)))
      ADD_FAILURE() << path.string() << " " << fault;
  }
}

// Without the macro, a program cannot call the header's functions. The header export.h
// also checks the program's compiler flags.
TEST(SourceRules, PublicHeadersExportWhatTheyDeclare)
{
  int checked = 0;
  for (const auto& [module, path] : codeFiles()) {
    if (path.extension() != ".h" || module == "apps" ||
        path.string().find("/include/") == std::string::npos)
      continue;
    const std::string text = readText(path), name = path.filename().string();
    EXPECT_EQ(text.find("\nnamespace pcl_semantic {"), std::string::npos)
        << path << ": expected namespace PCL_SEMANTIC_EXPORT pcl_semantic {";
    EXPECT_TRUE(name == "export.h" ||
                text.find("#include <pcl_semantic/core/export.h>\n") != text.npos)
        << path << ": expected #include <pcl_semantic/core/export.h>";
    ++checked;
  }
  EXPECT_GT(checked, 100);
}

// Declarations are found in the header with the source's name.
TEST(SourceRules, EverySourceHasItsHeaderOrIsAProgram)
{
  for (const auto& [module, path] : codeFiles()) {
    if (path.extension() != ".cpp" || path.parent_path().filename() == "examples")
      continue;
    fs::path header = path;
    header.replace_extension(".h");
    const fs::path exported = source_folder / "include/pcl_semantic" /
                              fs::relative(header, source_folder / "src");
    const bool is_program =
        module == "apps" && readText(path).find("\nmain(") != std::string::npos;
    EXPECT_TRUE(fs::exists(header) || fs::exists(exported) || is_program) << path;
  }
}

// So a compiler without precompiled headers shows whether a header stands alone.
TEST(SourceRules, SourcesIncludeTheirHeaderFirst)
{
  int checked = 0;
  for (const auto& [module, path] : codeFiles()) {
    const fs::path header =
        "pcl_semantic" /
        fs::relative(path, source_folder / "src").replace_extension(".h");
    if (path.extension() != ".cpp" || !fs::exists(source_folder / "include" / header))
      continue;
    const std::string text = readText(path);
    const std::string own = "#include <" + header.string() + ">\n";
    EXPECT_EQ(text.find("#include"), text.find(own))
        << path << ": expected first " << own;
    ++checked;
  }
  EXPECT_GT(checked, 90);
}

TEST(SourceRules, FilesNameTheirLicense)
{
  for (const auto& [module, path] : codeFiles())
    EXPECT_EQ(readText(path).find("// SPDX-License-Identifier: BSD-3-Clause\n"), 0u)
        << path;
}

// Eigen's square roots of floats begin with an approximation of the processor's, which
// is another one on Intel's than on AMD's.
TEST(SourceRules, SquareRootsAreExact)
{
  static const std::regex approximate("\\.(r?sqrt|cwiseSqrt)\\(\\)");
  EXPECT_TRUE(std::regex_search("a.sqrt();", approximate));
  EXPECT_TRUE(std::regex_search("a.matrix().cwiseSqrt()", approximate));
  EXPECT_FALSE(std::regex_search("std::sqrt(a)", approximate));
  for (const auto& [module, path] : codeFiles())
    EXPECT_FALSE(std::regex_search(readText(path), approximate)) << path;
}

TEST(SourceRules, NoFlagChangesTheInstructionSet)
{
  EXPECT_TRUE(hasInstructionSetFlag("add_compile_options(-O3 -march=native)\n"));
  EXPECT_TRUE(hasInstructionSetFlag("# fast\nset(F \"-mavx2\") # faster\n"));
  EXPECT_FALSE(hasInstructionSetFlag("# never -march\nadd_compile_options(-Wall)\n"));

  std::vector<fs::path> files = {source_folder / "CMakeLists.txt"};
  for (const char* const root : {"src", "apps", "test", "cmake"})
    for (const auto& entry : fs::recursive_directory_iterator(source_folder / root))
      if (entry.path().filename() == "CMakeLists.txt" ||
          entry.path().extension() == ".cmake")
        files.push_back(entry.path());
  ASSERT_GT(files.size(), 5u);
  for (const fs::path& path : files)
    EXPECT_FALSE(hasInstructionSetFlag(readText(path))) << path;
}

namespace {

// Appends text in lower case, without comment markers and with single spaces.
void
appendWords(const std::string& text, std::string& joined)
{
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    const std::size_t first = line.find_first_not_of(" \t/*!<");
    std::istringstream words(first == line.npos ? "" : line.substr(first));
    for (std::string word; words >> word; joined += word) {
      joined += joined.empty() ? "" : " ";
      for (char& letter : word)
        letter = letter >= 'A' && letter <= 'Z' ? char(letter - 'A' + 'a') : letter;
    }
  }
}

// The comments of C++ code, each as one line, outside of literals.
std::vector<std::string>
commentsIn(const std::string& code)
{
  std::vector<std::string> comments;
  std::size_t end_of_last = code.npos;
  for (std::size_t i = 0; i < code.size();) {
    const auto isAt = [&](const char* text) { return code.compare(i, 2, text) == 0; };
    const auto skipTo = [&](const std::string& text, std::size_t from) {
      i = std::min(code.find(text, from), code.size() - text.size()) + text.size();
    };
    const std::size_t begin = i;
    if (isAt("//") || isAt("/*")) {
      const bool is_line = isAt("//");
      skipTo(is_line ? "\n" : "*/", begin + 2);
      const bool continues = is_line && end_of_last != code.npos &&
                             code.find_first_not_of(' ', end_of_last) == begin;
      if (!continues)
        comments.emplace_back();
      appendWords(code.substr(begin, i - begin - (is_line ? 0 : 2)), comments.back());
      end_of_last = is_line ? i : code.npos;
    }
    else if (isAt("R\"")) {
      const std::size_t parenthesis = code.find('(', i);
      skipTo(")" + code.substr(i + 2, parenthesis - i - 2) + "\"", parenthesis);
    }
    else if (code[i] == '"' || (code[i] == '\'' &&
                                (i == 0 || !std::isalnum(std::uint8_t(code[i - 1]))))) {
      for (++i; i < code.size() && code[i] != code[begin]; ++i)
        i += code[i] == '\\';
      ++i;
    }
    else
      ++i;
  }
  return comments;
}

// The paragraphs of a guide, each as one line, without code.
std::vector<std::string>
paragraphsIn(const std::string& guide)
{
  std::vector<std::string> paragraphs(1);
  bool is_code = false;
  std::istringstream stream(guide);
  for (std::string line; std::getline(stream, line);) {
    if (line.find("```") != line.npos)
      is_code = !is_code;
    else if (!is_code && line.empty())
      paragraphs.emplace_back();
    else if (!is_code)
      appendWords(line, paragraphs.back());
  }
  for (std::string& paragraph : paragraphs)
    paragraph = std::regex_replace(paragraph, std::regex("`[^`]*`"), "`");
  return paragraphs;
}

// Phrases without a subject, or with a plain word instead.
const std::vector<std::string> worst_phrases = {
    "brief (?:what|who|where|how|those)",
    "what (?:is|was|are|were|it|they|has|had|a|an|the|goes|comes)",
    "who(?:ever|m)?",
    "(?:some|any|no)body",
    "sa(?:y|ys|id) (?:so|it|of|what|how|whether|nothing)",
    "hear(?:s|d)?",
    "but for",
    "go(?:es)? on",
    "(?:is|are|was|were) passed over",
    "stands? for (?:it|them|the)",
    "knows? (?:nothing|only|of|what|about|where|none)",
    "by (?:itself|themselves)",
    "(?:at|in) one go",
    "without a word",
    "do(?:es)? as well",
    "the same of",
    "half as (?:long|much|many) again",
    "ma(?:de|kes?) up for",
    "(?:is|are) no use",
    "anew",
    "to the bit",
    "(?:is|are) (?:worth|believed)",
    "so many",
    "the other way round",
    "less (?:the|its|their)",
    "check sums?",
    "witness(?:es)?",
    "as (?:it|they) st(?:ood|ands?)",
    "feet",
    "means? nothing",
    "bears?",
    "where (?:there|it) (?:is|was|are) none",
    "cannot be told",
    "whole or not at all",
    "(?:lies?|is|are) nowhere",
    "became of",
    "forgets?",
    "for ever",
    "as far as there (?:is|are)",
    "in the place of"};

// The first of these phrases in any text; empty if there is none.
std::string
worstPhraseIn(const std::vector<std::string>& texts)
{
  static const std::regex any = [] {
    std::string all;
    for (const std::string& phrase : worst_phrases)
      all += (all.empty() ? "" : "|") + phrase;
    return std::regex("\\b(?:" + all + ")\\b",
                      std::regex::nosubs | std::regex::optimize);
  }();
  std::smatch found;
  for (const std::string& text : texts)
    if (std::regex_search(text, found, any))
      return found.str() + "' in '" + text;
  return {};
}

} // namespace

TEST(SourceRules, TheCheckerFindsBadPhrases)
{
  EXPECT_EQ(commentsIn("/** \\brief a\n   * b */ int c; ///< d\n  // e\n\n// f\n"
                       "g(\"// h\", '\"', 1'000, R\"(// i)\"); // j\n"),
            (std::vector<std::string>{"\\brief a b", "d e", "f", "j"}));
  EXPECT_EQ(paragraphsIn("a\n`b` c\n\n```\nd\n```\ne\n"),
            (std::vector<std::string>{"a ` c", "e"}));
  EXPECT_EQ(worstPhraseIn({"the same", "a file of\nnobody"}),
            "nobody' in 'a file of\nnobody");
  EXPECT_EQ(worstPhraseIn(commentsIn("// \\brief What a")),
            "brief what' in '\\brief what a");
}

TEST(SourceRules, CommentsNameWhatActs)
{
  int comments = 0, guides = 0;
  for (const char* const root : {"include", "src", "apps", "python", "test"})
    for (const auto& entry : fs::recursive_directory_iterator(source_folder / root))
      if (entry.is_regular_file() && isCode(entry.path())) {
        const auto found = commentsIn(readText(entry.path()));
        EXPECT_EQ(worstPhraseIn(found), "") << entry.path();
        comments += int(found.size());
      }
  std::vector<fs::path> paths = {source_folder / "README.md",
                                 source_folder / "CONTRIBUTING.md"};
  for (const auto& entry : fs::directory_iterator(source_folder / "doc"))
    if (entry.path().extension() == ".md" &&
        entry.path().filename().string().rfind("results", 0) != 0)
      paths.push_back(entry.path());
  for (const fs::path& path : paths) {
    EXPECT_EQ(worstPhraseIn(paragraphsIn(readText(path))), "") << path;
    ++guides;
  }
  EXPECT_GT(comments, 3000);
  EXPECT_GT(guides, 20);
}

// The lines of each hunk that are not added have to be in the file, one after another.
TEST(SourceRules, RecipesFitTheSources)
{
  std::istringstream guide(readText(source_folder / "CONTRIBUTING.md"));
  std::string line, file, old_lines;
  bool is_diff = false;
  int hunks = 0;
  const auto endHunk = [&] {
    if (!old_lines.empty()) {
      ++hunks;
      EXPECT_NE(readText(source_folder / file).find(old_lines), std::string::npos)
          << file << " lacks\n"
          << old_lines;
    }
    old_lines.clear();
  };
  while (std::getline(guide, line)) {
    if (line.rfind("```", 0) == 0 || line.rfind("@@", 0) == 0 ||
        line.rfind("+++ ", 0) == 0)
      endHunk();
    if (line.rfind("```", 0) == 0)
      is_diff = line == "```diff";
    else if (is_diff && line.rfind("+++ ", 0) == 0)
      file = line.substr(4);
    else if (is_diff && !line.empty() && line[0] != '+' && line[0] != '@')
      old_lines += line.substr(1) + "\n";
  }
  EXPECT_GE(hunks, 12);
}

TEST(SourceRules, PackagesHaveTheVersionOfTheProject)
{
  const std::string project = readText(source_folder / "CMakeLists.txt");
  std::smatch match;
  ASSERT_TRUE(std::regex_search(project, match,
                                std::regex("VERSION (([0-9]+\\.[0-9]+)\\.[0-9]+)")));
  const std::string version = match[1], soname = match[2];
  const auto holds = [](const char* file, const std::string& text) {
    return readText(source_folder / file).find(text) != std::string::npos;
  };
  EXPECT_TRUE(holds("package.xml", "<version>" + version + "</version>"));
  EXPECT_EQ(
      readText(source_folder / "debian/changelog").find("pcl-semantic (" + version),
      0u);
  EXPECT_TRUE(holds("debian/control", "Package: libpcl-semantic" + soname + "\n"));
  EXPECT_TRUE(holds("debian/rules", "libpcl-semantic" + soname + ","));
}
